// Numbers of remedies: short, and on the side on which they cure.
#pragma once

#include <cmath>

namespace selvage {

namespace detail {
inline double unit_of_third_digit(double value) {
  return std::pow(10.0, std::floor(std::log10(value)) - 2.0);
}
}  // namespace detail

// To three digits, not less than the value (> 0) but for rounding.
inline double rounded_up(double value) {
  const double unit = detail::unit_of_third_digit(value);
  return std::ceil(value / unit - 1e-9) * unit;
}

// To three digits, not more than the value (> 0) but for rounding.
inline double rounded_down(double value) {
  const double unit = detail::unit_of_third_digit(value);
  return std::floor(value / unit + 1e-9) * unit;
}

}  // namespace selvage
