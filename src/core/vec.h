// Points and vectors. Plain double precision; lengths are in the unit of the file that they come from
// unless a name says otherwise.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>

namespace selvage {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;

// The smallest box with faces along the axes that holds a set of points; empty() until a point is added.
using Box3 = Eigen::AlignedBox3d;

// Zero where it has no direction.
inline Vec3 unit_or_zero(const Vec3& v) {
  const double size = v.norm();
  return size > 0 ? Vec3(v / size) : Vec3(Vec3::Zero());
}

// Where the segment from `a` to `b` is nearest to `p`: 0 at `a`, 1 at `b`.
template <class Vec>
double nearest_share(const Vec& p, const Vec& a, const Vec& b) {
  const Vec way = b - a;
  const double square = way.squaredNorm();
  return square > 0 ? std::clamp((p - a).dot(way) / square, 0.0, 1.0) : 0.0;
}

}  // namespace selvage
