// Parameters at which a curve or surface is looked at: its knots, and places between them.
#pragma once

#include <algorithm>
#include <vector>

#include "nurbs/spline.h"

namespace selvage::nurbs {

// The breaks (increasing, at least one), and between them span k cut into parts[k] >= 1 equal ones.
inline std::vector<double> divided(const std::vector<double>& breaks, const std::vector<int>& parts) {
  std::vector<double> all;
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
    for (int i = 0; i < parts[k]; ++i) all.push_back(breaks[k] + (breaks[k + 1] - breaks[k]) * i / parts[k]);
  all.push_back(breaks.back());
  return all;
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
inline double length_of(const std::vector<Vec3>& points) {
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

}  // namespace selvage::nurbs
