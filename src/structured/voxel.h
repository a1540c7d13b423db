// A unit cell as a grid of equal hexahedra (cuboids; parallelepipeds in an oblique cell): the mesh that can
// always be made. The surfaces of the yarns are
// stairs in it; stresses beside them mean little, the stiffness of the whole converges slowly.
#pragma once

#include <array>
#include <span>

#include "core/diagnostics.h"
#include "fabric/model.h"
#include "fem/mesh.h"
#include "yarn/body.h"

namespace selvage::fem {

struct VoxelOptions {
  int count = 0;                   // along the longest side of the cell, 1 .. 10 000
  std::array<bool, 3> periodic{};  // x, y, z
  bool matrix = true;              // false: the yarns only
  Physics physics = Physics::elastic;
  int threads = 1;
};

// The mesh of the fabric's cell (there must be one), nodes in mm; hexahedra as near to cubes as whole numbers
// along the sides allow. One region a yarn that has a hexahedron, in the order of `bodies`, then the matrix.
// A hexahedron is its yarn's whose inside its middle lies in; of two that overlap the one with the nearer
// centre line, with a note. Warnings, at the cell: where the voxels are more than 5 % off the yarns' volume
// in it (with a count that is not, found by doubling), and of yarns as large as a voxel that have none.
// Orientations, fibre fractions, sets and equations as in every cell (fem/fibre.h,
// cell_problem/complete_cell.h). Region::exact_volume is 0 where yarns overlap in the cell's faces. Errors:
// usage (count), limit (more than 20 million hexahedra), geometry (no yarn in the cell; a matrix is wanted
// but not named), and those of choose_cell_materials (fem/materials.h).
Result<Mesh> mesh_voxels(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                         const VoxelOptions& options, Diagnostics& diagnostics);

}  // namespace selvage::fem
