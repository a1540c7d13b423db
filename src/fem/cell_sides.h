// The sides of tetrahedra, those of equal corners beside each other.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"

namespace selvage::fem {

// Six times a tetrahedron's volume.
inline double six_volumes(std::span<const Vec3> points, const std::array<std::uint32_t, 4>& cell) {
  const Vec3& p = points[cell[0]];
  return (points[cell[1]] - p).cross(points[cell[2]] - p).dot(points[cell[3]] - p);
}

// The corners of the side opposite each corner, counter-clockwise seen from outside of a positive one.
inline constexpr std::array<std::array<std::size_t, 3>, 4> opposite_sides = {
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

struct CellSide {
  std::array<std::uint32_t, 3> corners;  // increasing
  std::uint32_t cell;
  std::uint32_t slot;  // of the corner opposite
  bool even;           // an even permutation of opposite_sides brought the corners into order
};

CellSide side_of(const std::array<std::uint32_t, 4>& cell, std::uint32_t number, std::uint32_t slot);

// All sides by their corners, then by their cells. Corners are below `points`.
std::vector<CellSide> sorted_sides(std::span<const std::array<std::uint32_t, 4>> cells, std::size_t points);

}  // namespace selvage::fem
