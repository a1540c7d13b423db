// The box of some points.
#pragma once

#include <ranges>

#include "core/vec.h"

namespace selvage {

template <class Points>
auto bounds_of(const Points& points) {
  Eigen::AlignedBox<double, std::ranges::range_value_t<Points>::RowsAtCompileTime> box;
  for (const auto& p : points) box.extend(p);
  return box;
}

}  // namespace selvage
