// Yarns that are the same but for a rigid motion: found by their control points, not by how they were made.
#pragma once

#include <array>
#include <optional>

#include "yarn/body.h"

namespace selvage::yarn {

// x -> rotation * x + offset; the rotation is proper (no mirror image).
struct RigidMotion {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Vec3 offset = Vec3::Zero();
  // The identity, to the bit.
  [[nodiscard]] bool is_translation() const { return rotation == Eigen::Matrix3d::Identity(); }
  Vec3 operator()(const Vec3& point) const { return rotation * point + offset; }
};

// Numbers that a rigid motion leaves as they are but for rounding: to find candidates without comparing all
// pairs. Lengths in file units.
struct Invariants {
  std::array<double, 4> sizes{};
};
Invariants invariants_of(const Body& body);
// Could the two be congruent, with this distance left?
bool are_alike(const Invariants& a, const Invariants& b, double tolerance);

struct Congruence {
  RigidMotion motion;    // of the first body onto the second
  double deviation = 0;  // bound on the distance between points of equal parameters then, file units
};
// The motion that brings `first` onto `second`, control point onto control point in their order, body and end
// faces; nothing where there is none that leaves at most `tolerance`. Names, colours and roles do not count.
// A yarn whose parameters run the other way, or begin elsewhere on the section, is another one here. The
// motion is a translation where that will do; else the best rotation (Kabsch 1976) of the control points.
std::optional<Congruence> congruence(const Body& first, const Body& second, double tolerance);

}  // namespace selvage::yarn
