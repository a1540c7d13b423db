// The shortest translation that meets demands along several directions.
#pragma once

#include <optional>
#include <vector>

#include "core/vec.h"

namespace selvage::contact {

// At least `distance` along the unit vector `normal`.
struct ShiftDemand {
  Vec3 normal = Vec3::Zero();
  double distance = 0;
};

// The least t with normal . t >= distance for all demands: a quadratic program in three unknowns, by trying
// sets of at most three demands that hold exactly. Nothing: they contradict each other.
std::optional<Vec3> least_shift(const std::vector<ShiftDemand>& demands);

}  // namespace selvage::contact
