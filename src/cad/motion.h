// Is one set of points the other one, moved?
#pragma once

#include <optional>
#include <vector>

#include "core/vec.h"

namespace selvage::cad {

struct Motion {
  Vec3 shift = Vec3::Zero();  // of the points' mean
  double angle = 0;           // degrees, 0 <= angle <= 180, about `axis` through the mean; 0: a translation
  Vec3 axis = Vec3::Zero();   // unit, or zero
};

// The motion that takes each point of `from` to its partner in `to` within `near`: a translation where there
// is one, else a rigid motion (Kabsch); none where no motion does.
std::optional<Motion> motion_between(const std::vector<Vec3>& from, const std::vector<Vec3>& to, double near);

}  // namespace selvage::cad
