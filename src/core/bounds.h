// The box of some points, and what has no bound.
#pragma once

#include <limits>
#include <ranges>

#include "core/vec.h"

namespace selvage {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

template <class Points>
auto bounds_of(const Points& points) {
  Eigen::AlignedBox<double, std::ranges::range_value_t<Points>::RowsAtCompileTime> box;
  for (const auto& p : points) box.extend(p);
  return box;
}

}  // namespace selvage
