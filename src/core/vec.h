// Points and vectors. Plain double precision; lengths are in the unit of the file that they come from
// unless a name says otherwise.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace selvage {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;

// The smallest box with faces along the axes that holds a set of points; empty() until a point is added.
using Box3 = Eigen::AlignedBox3d;

}  // namespace selvage
