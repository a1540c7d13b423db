// Numbers that begin anew after a period.
#pragma once

#include <cmath>
#include <concepts>

namespace selvage {

// Of 0 .. period - 1 the one that `number` is a whole number of periods away from.
template <std::signed_integral Number>
Number wrapped(Number number, Number period) {
  const Number rest = number % period;
  return rest < 0 ? rest + period : rest;
}

// The same of a parameter that goes round from `first` to `last`.
inline double wrapped(double t, double first, double last) {
  const double period = last - first;
  return t - period * std::floor((t - first) / period);
}

}  // namespace selvage
