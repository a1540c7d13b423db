// The boxes of equal size that fill a unit cell.
#pragma once

#include <array>
#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"

namespace selvage::fem {

// The coordinates of its planes along x, y and z, file units; first and last are the cell's own.
struct VoxelGrid {
  std::array<std::vector<double>, 3> planes;

  [[nodiscard]] std::size_t count(std::size_t axis) const { return planes[axis].size() - 1; }
  [[nodiscard]] std::size_t voxels() const { return count(0) * count(1) * count(2); }
  [[nodiscard]] Vec3 sides() const {  // of a voxel
    return {planes[0][1] - planes[0][0], planes[1][1] - planes[1][0], planes[2][1] - planes[2][0]};
  }
  [[nodiscard]] std::vector<double> middles(std::size_t axis) const;
};

// `count` (1 .. 10 000) voxels along the longest side of `box`, along the others as many as make them nearest
// to cubes. Errors: usage (count), limit (more than `most`; `what` they are: "hexahedra").
Result<VoxelGrid> make_grid(const Box3& box, int count, double most, const char* what);

}  // namespace selvage::fem
