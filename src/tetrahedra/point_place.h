// The best place for one inner point.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/vec.h"

namespace selvage::fem {

using StarSide = std::array<Vec3, 3>;  // (point, side) is positive

// Moves a point within the sides of its star such that the smallest dihedral angle of all its tetrahedra
// grows: steepest ascent of a minimum of smooth functions, along the shortest vector in the hull of the
// gradients of those that are smallest. Stops when `goal` (a quality) is reached. Returns the quality there.
// `normal` (unit): the point stays in the plane across it; zero: it may go anywhere.
class PointPlace {
 public:
  double improve(Vec3& at, std::span<const StarSide> sides, double goal, const Vec3& normal = Vec3::Zero());

 private:
  struct Angle {
    double value = 0;  // radians
    Vec3 slope = Vec3::Zero();
  };
  void measure(const Vec3& at, std::span<const StarSide> sides, double below, const Vec3& normal);

  std::vector<double> qualities_;
  std::vector<Angle> angles_;
  std::vector<Vec3> active_;
};

}  // namespace selvage::fem
