// The rotation that brings one set of points nearest to another.
#pragma once

#include <span>
#include <vector>

#include "core/vec.h"

namespace selvage::yarn {

Vec3 mean_of(std::span<const Vec3> points);

// Proper, about the means of both: the sum of the squared distances of partners is least (Kabsch 1976). As
// many points in one as in the other, at least one.
Eigen::Matrix3d best_rotation(const std::vector<Vec3>& from, const std::vector<Vec3>& to);

}  // namespace selvage::yarn
