// The space between the yarns of a unit cell, for a fluid: the matrix's region alone, and the patches around
// it.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/diagnostics.h"
#include "fem/mesh.h"

namespace selvage::fem {

// Leaves only the matrix of a cell's mesh, as a region "pores" without a material: its nodes are numbered
// anew in their order, and Mesh::patches has one wall for each yarn that it touches, in the order of the
// yarns. Precondition: regions share nodes, the matrix is the last one, the cell is not complete
// (cell_problem/complete_cell.h). Error (geometry): there is no matrix.
Status keep_pores(Mesh& mesh);

// Adds the patches on the faces of a complete cell, behind the walls: x_low, x_high of periodic axes,
// inlet_x, outlet_x of others; those that have sides.
void add_face_patches(Mesh& mesh);

// Where a fluid can go. A passage along an axis leads from a place to the same place of the next cell, or
// along an axis that is not periodic from the low face to the high one.
struct Passages {
  std::array<bool, 3> along{};      // x, y, z
  std::size_t pockets = 0;          // parts of the space that no passage crosses
  double pocket_volume = 0;         // theirs, mm3
  std::vector<Vec3> pocket_places;  // a place in each, mm; at most ten
};

// Precondition: the patches are complete.
Passages find_passages(const Mesh& mesh);

}  // namespace selvage::fem
