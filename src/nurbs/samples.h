// A surface as points where lines of constant u and lines of constant v cross.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "nurbs/spline.h"

namespace selvage::nurbs {

struct Samples {
  std::vector<double> us, vs;  // increasing; one column a u, one row a v
  std::vector<Vec3> points;    // u fastest

  Samples() = default;
  Samples(const Surface& surface, std::vector<double> of_u, std::vector<double> of_v)
      : us(std::move(of_u)), vs(std::move(of_v)), points(evaluate_grid(surface, us, vs)) {}

  [[nodiscard]] std::size_t index(std::size_t i, std::size_t j) const { return j * us.size() + i; }
  [[nodiscard]] const Vec3& at(std::size_t i, std::size_t j) const { return points[index(i, j)]; }
  [[nodiscard]] std::span<const Vec3> row(std::size_t j) const {
    return std::span(points).subspan(j * us.size(), us.size());
  }

  // The largest of what measure(line's points) says of the lines along u (or v): of each the `count` points
  // from its number `first` on. At least 0.
  template <std::size_t count, class Measure>
  [[nodiscard]] double largest(bool along_v, std::size_t first, const Measure& measure) const {
    double largest = 0.0;
    std::array<Vec3, count> line;
    for (std::size_t l = 0; l < (along_v ? us : vs).size(); ++l) {
      for (std::size_t k = 0; k < count; ++k) line[k] = along_v ? at(l, first + k) : at(first + k, l);
      largest = std::max<double>(largest, measure(line));
    }
    return largest;
  }
};

}  // namespace selvage::nurbs
