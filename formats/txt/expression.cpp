#include "formats/txt/expression.h"

#include "core/module.h"

namespace selvage::formats::txt {

Result<double> value_of(std::string_view expression, std::span<const NamedValue> names,
                        std::span<const NamedValue> units) {
  return call(module_table<ExpressionModule>("muparser", "selvage_muparser"), &ExpressionModule::value_of,
              expression, names, units);
}

}  // namespace selvage::formats::txt
