// The least translation that ends an overlap.
#pragma once

#include <vector>

#include "solid/tessellation.h"

namespace selvage::solid {

// How far one yarn has to go along a direction, and which points part last.
struct Parting {
  double distance = 0;                      // 0: nothing shared was seen
  std::uint32_t a = 0, b = 0;               // triangles of the two skins
  Vec3 p = Vec3::Zero(), q = Vec3::Zero();  // on them; p - q = distance * direction
};

// Two skins (closed, or parts of skins) that share the space round some points. parting(n): how far A has to
// go along -n until that space is shared no more: on every line along n through it, A's piece [a0, a1] and
// B's piece [b0, b1] that overlap part by a1 - b0, and the largest of these counts. Lines are tried on a
// square raster.
class SharedSpace {
 public:
  // `walls`: points whose box holds the shared space; what the skins share elsewhere is not looked at.
  // `whole`: both skins are closed, and pieces run from wall to wall; otherwise each skin is a sheet, A's
  // facing along the direction and B's against it.
  SharedSpace(const Tessellation& a, const Tessellation& b, std::vector<Vec3> walls, bool whole)
      : a_(a), b_(b), walls_(std::move(walls)), whole_(whole) {}

  [[nodiscard]] Parting parting(const Vec3& direction) const;

  // The direction in which the least movement parts them, by compass search from the best of `starts` (unit
  // vectors).
  [[nodiscard]] Vec3 easiest_direction(const std::vector<Vec3>& starts) const;

 private:
  class View;

  const Tessellation& a_;
  const Tessellation& b_;
  std::vector<Vec3> walls_;
  bool whole_;
};

// 26 directions: the faces, edges and corners of a cube.
std::vector<Vec3> directions_all_round();

}  // namespace selvage::solid
