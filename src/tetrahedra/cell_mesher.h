// The conformal tetrahedral mesh of a unit cell: the parts of the yarns inside a box, and the matrix between
// them, which share the triangles where they meet.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "cell_problem/layers.h"
#include "core/diagnostics.h"
#include "fabric/model.h"
#include "tetrahedra/block.h"
#include "yarn/body.h"

namespace selvage::fem {

struct CellMeshOptions : MeshOptions {
  std::vector<double> sizes{};  // one a body: the largest edge on its surface; empty: `size`
  double coarsest = 0;          // file units: to which edges may grow away from the yarns; 0: as on the yarns
  double growth = usual_growth;  // of edges, per length
  bool matrix = true;            // false: only the yarns, cut flush
  bool pores = false;            // with `matrix`: only that, with patches (cell_problem/pores.h)
  LayerOptions layers{};         // with `pores`, order 1: along the walls; count 0: none; file units
  // File units: matrix between yarns that are this near becomes part of them (cell_problem/bond.h); 0: none.
  double bond = 0;
  std::array<bool, 3> periodic{};  // opposite faces get the same triangles
  // Other than bonded with a matrix alone. Cohesive: of elastic materials; with `bond` yarns have to share
  // faces.
  Joining joining = Joining::bonded;
  Physics physics = Physics::elastic;
  double tolerance = 0;  // file units; 0: 1e-3 of the smallest section extent
};

// The mesh of `fabric.cell`, in mm. Regions: the yarns that have elements, in their order (all parts of a
// yarn are one), then the matrix. Bodies reach beyond the cell wherever the yarn goes on there. Nodes stand
// on the box's faces to the bit, opposite ones (periodic axes) at equal places to the bit but for the axis
// itself. Exact volumes are those of the B-spline yarns inside the box. Notes and warnings (what was snapped,
// elements below the wanted angle and why) go to `diagnostics`. Errors, with yarn, place and remedy: geometry
// (what cell::cut and cell::divide_faces say; yarns that do not go on periodically, or touch), limit (time,
// memory), usage (options out of range, no cell), internal, and those of choose_cell_materials
// (fem/materials.h).
Result<Mesh> mesh_cell(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                       const CellMeshOptions& options, Diagnostics& diagnostics);

}  // namespace selvage::fem
