#include <fmt/format.h>
#include <muParser.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/module.h"
#include "formats/txt/expression.h"

namespace selvage::formats::txt {

namespace {

// muParser's operators are bare functions: where their units stand, they find here.
constexpr std::size_t most_units = 32;
thread_local std::array<double, most_units> unit_values{};

template <std::size_t Index>
double times_unit(double value) {
  return value * unit_values[Index];
}

template <std::size_t... Index>
void define_units(mu::Parser& parser, std::span<const NamedValue> units, std::index_sequence<Index...>) {
  constexpr std::array<mu::fun_type1, most_units> operators{&times_unit<Index>...};
  for (std::size_t i = 0; i < units.size() && i < most_units; ++i) {
    unit_values[i] = units[i].value;
    parser.DefinePostfixOprt(units[i].name, operators[i]);
  }
}

Result<double> evaluate(std::string_view expression, std::span<const NamedValue> names,
                        std::span<const NamedValue> units) {
  try {
    mu::Parser parser;
    parser.ClearConst();
    parser.DefineConst("pi", std::numbers::pi);
    for (const NamedValue& named : names) parser.DefineConst(named.name, named.value);
    define_units(parser, units, std::make_index_sequence<most_units>());
    parser.SetExpr(std::string(expression));
    int results = 0;
    const double* const values = parser.Eval(results);
    if (results != 1) return error(Kind::malformed, "it has several values, divided by commas");
    if (!std::isfinite(values[0]))
      return error(Kind::malformed, "its value is no finite number: it divides by zero, or is too large");
    return values[0];
  } catch (const mu::Parser::exception_type& failure) {
    const std::string& token = failure.GetToken();
    switch (failure.GetCode()) {
      case mu::ecUNASSIGNABLE_TOKEN:
        return error(Kind::malformed, fmt::format("'{}' is not known", token));
      case mu::ecUNEXPECTED_EOF:
        return error(Kind::malformed, "it ends too early");
      case mu::ecMISSING_PARENS:
        return error(Kind::malformed, "a bracket is not closed");
      default:
        if (token.empty()) return error(Kind::malformed, failure.GetMsg());
        return error(Kind::malformed, fmt::format("'{}' does not belong there", token));
    }
  }
}

Result<double> guarded(std::string_view expression, std::span<const NamedValue> names,
                       std::span<const NamedValue> units) {
  return guarded_by_module("the expression", [&] { return evaluate(expression, names, units); });
}

const std::string version = mu::Parser().GetVersion(mu::pviBRIEF);

}  // namespace

}  // namespace selvage::formats::txt

extern "C" __attribute__((visibility("default"))) const void* selvage_muparser() {
  using namespace selvage::formats::txt;
  static const ExpressionModule table = {version, &guarded};
  return &table;
}
