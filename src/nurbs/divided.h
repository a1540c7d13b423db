// Parameters at which a curve or surface is looked at: its knots, and places between them.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <vector>

#include "nurbs/spline.h"

namespace selvage::nurbs {

// How many parts a span is cut into that `wanted` asks for: rounded up, `least` to `most`.
inline int whole_parts(double wanted, int least, int most) {
  return static_cast<int>(
      std::clamp(std::ceil(wanted), static_cast<double>(least), static_cast<double>(most)));
}

// The breaks (increasing, at least one), and between them span k cut into parts[k] equal ones, a whole number
// >= 1.
template <class Number>
std::vector<double> divided(const std::vector<double>& breaks, const std::vector<Number>& parts) {
  std::vector<double> all;
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
    for (int i = 0; i < parts[k]; ++i) all.push_back(breaks[k] + (breaks[k + 1] - breaks[k]) * i / parts[k]);
  all.push_back(breaks.back());
  return all;
}

// The same into parts_of(k), an int.
template <std::invocable<std::size_t> Parts>
std::vector<double> divided(const std::vector<double>& breaks, const Parts& parts_of) {
  std::vector<int> parts;
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) parts.push_back(parts_of(k));
  return divided(breaks, parts);
}

// Each knot of the domain once, and between them every span cut into as many.
inline std::vector<double> divided(const std::vector<double>& knots, int degree, int parts) {
  const std::vector<double> breaks = breakpoints(knots, degree);
  return divided(breaks, std::vector<int>(breaks.size() - 1, parts));
}

// The same, into `parts` or more, so that there are at least `least` in all.
inline std::vector<double> divided(const std::vector<double>& knots, int degree, int parts, int least) {
  const std::vector<double> breaks = breakpoints(knots, degree);
  const int spans = static_cast<int>(breaks.size()) - 1;
  return divided(breaks, std::vector<int>(breaks.size() - 1, std::max(parts, (least + spans - 1) / spans)));
}

// Of the polygon through these points.
template <class Points>
double length_of(const Points& points) {
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

}  // namespace selvage::nurbs
