// The value of an expression over names, by muParser (https://beltoforion.de/en/muparser), which is opened
// only where a text has one.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/diagnostics.h"

namespace selvage::formats::txt {

struct NamedValue {
  std::string name;
  double value = 0;
};

// +, -, *, /, ^, brackets, comparisons, `a ? b : c`, and muParser's functions (sin, sqrt, min, ...; angles in
// radians) of decimal numbers, the names and `pi`. A unit behind a number is an operator: the number times
// its value. Names and units are words of letters, digits and `_`. Errors (malformed): what is wrong with it;
// that it is no finite number.
Result<double> value_of(std::string_view expression, std::span<const NamedValue> names,
                        std::span<const NamedValue> units);

// What the module has.
struct ExpressionModule {
  std::string_view version;
  Result<double> (*value_of)(std::string_view expression, std::span<const NamedValue> names,
                             std::span<const NamedValue> units);
};

}  // namespace selvage::formats::txt
