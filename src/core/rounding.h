// Numbers of remedies: short, and on the side on which they cure. Lengths as ratios, the same in every unit.
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

// A length in units of another one, in 33 bits: without the rounding that the unit of both has left, which a
// solver that stops or chooses somewhere makes large.
inline double in_units_of(double unit, double length) {
  constexpr int bits = 33;
  int exponent = 0;
  const double fraction = std::frexp(length / unit, &exponent);
  return std::ldexp(std::round(std::ldexp(fraction, bits)), exponent - bits);
}

}  // namespace selvage
