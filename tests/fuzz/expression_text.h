// Numbers of Fabric TXT with units, params and expressions, out of bytes that decide; and what they are
// worth.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace selvage::fuzz {

struct ExpressionText {
  std::string text;             // a Fabric TXT: a path along x, y and z by numbers
  std::vector<double> numbers;  // of its rows, one after the other, in the file's unit; reckoned here
};

// None of the values is beyond 10^4 or nearer to zero than 0.01, but for zero itself: rounding stays that.
ExpressionText expression_text(std::string_view bytes);

}  // namespace selvage::fuzz
