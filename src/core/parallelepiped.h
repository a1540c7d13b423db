// A parallelepiped: a box in coordinates of its own, along axes that need not be at right angles.
#pragma once

#include <array>
#include <cmath>

#include "core/vec.h"

namespace selvage {

// Coordinates along three unit vectors, which are right-handed: q stands for the place unit * q. Those of
// space themselves as long as nothing else is said; places are then theirs to the bit.
class ObliqueAxes {
 public:
  ObliqueAxes() = default;
  // Along these vectors, which span a space; their lengths do not matter. The third is x, y or z where it was
  // one.
  explicit ObliqueAxes(const std::array<Vec3, 3>& along) : is_space_(false) {
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3& v = along[static_cast<std::size_t>(axis)];
      unit_.col(axis) = v / v.norm();
    }
    own_ = unit_.inverse();
    is_space_ = unit_ == Eigen::Matrix3d::Identity();
  }

  // Those of space?
  [[nodiscard]] bool are_of_space() const { return is_space_; }
  [[nodiscard]] Vec3 own(const Vec3& place) const { return is_space_ ? place : Vec3(own_ * place); }
  [[nodiscard]] Vec3 place(const Vec3& own) const { return is_space_ ? own : Vec3(unit_ * own); }
  [[nodiscard]] Vec3 unit(int axis) const { return unit_.col(axis); }
  // Of the planes on which the coordinate is constant; the coordinate grows along it.
  [[nodiscard]] Vec3 normal(int axis) const {
    return is_space_ ? Vec3(Vec3::Unit(axis)) : Vec3(own_.row(axis).transpose().normalized());
  }
  // From coordinates to places, and back.
  [[nodiscard]] const Eigen::Matrix3d& to_space() const { return unit_; }
  [[nodiscard]] const Eigen::Matrix3d& to_own() const { return own_; }

  bool operator==(const ObliqueAxes& other) const { return unit_ == other.unit_; }

 private:
  Eigen::Matrix3d unit_ = Eigen::Matrix3d::Identity(), own_ = Eigen::Matrix3d::Identity();
  bool is_space_ = true;
};

struct Parallelepiped {
  Box3 box;  // in the axes' coordinates
  ObliqueAxes axes{};

  Parallelepiped() = default;
  // Implicit: a box is one.
  Parallelepiped(const Box3& own, const ObliqueAxes& along = {}) : box(own), axes(along) {}

  // From each place of the low face to the one opposite.
  [[nodiscard]] Vec3 edge(int axis) const { return axes.unit(axis) * box.sizes()[axis]; }
  [[nodiscard]] double volume() const {
    return axes.are_of_space() ? box.volume() : axes.to_space().determinant() * box.volume();
  }
  [[nodiscard]] Vec3 middle() const { return axes.place(box.center()); }
  // The box along the axes of space that it lies in.
  [[nodiscard]] Box3 bounds() const {
    if (axes.are_of_space()) return box;
    Box3 result;
    for (int corner = 0; corner < 8; ++corner)
      result.extend(axes.place(box.corner(static_cast<Box3::CornerType>(corner))));
    return result;
  }
  [[nodiscard]] bool contains(const Vec3& place) const { return box.contains(axes.own(place)); }
  // The place with one of its coordinates another one.
  [[nodiscard]] Vec3 with(const Vec3& place, int axis, double coordinate) const {
    Vec3 q = axes.own(place);
    q[axis] = coordinate;
    return axes.place(q);
  }
  // In which of the two faces across an axis a place is, to a part in 1e12 of the size: -1 low, 1 high, 0 in
  // neither.
  [[nodiscard]] int side_of(const Vec3& place, int axis) const {
    const double snug = 1e-12 * box.sizes().maxCoeff(), own = axes.own(place)[axis];
    if (std::abs(own - box.min()[axis]) <= snug) return -1;
    return std::abs(own - box.max()[axis]) <= snug ? 1 : 0;
  }
};

}  // namespace selvage
