// Everything that bounds and parts the regions of a unit cell, as triangles that share their nodes.
#pragma once

#include <vector>

#include "core/diagnostics.h"
#include "surface_mesh/cell_curves.h"
#include "surface_mesh/end_cap.h"
#include "surface_mesh/triangle.h"

namespace selvage::fem {

struct CellTriangles {
  std::vector<Triangle> triangles;
  // The bodies on both sides, or `matrix`, or Sides::outside; by index of the body.
  static constexpr std::uint32_t matrix = Sides::outside - 1;
  std::vector<Sides> sides;
  enum class Part : std::uint8_t { side, start, end, box };  // of a yarn, or a face of the box
  std::vector<Part> parts;
  // End faces of yarns inside the box: the shape over their own triangles.
  struct Cap {
    EndCap shape;
    std::size_t first = 0, count = 0;  // into `triangles`
  };
  std::vector<Cap> caps;
};

// The yarns' surfaces inside the box, node places on the B-spline surface, sharp crests as edges; then the
// faces of the box: on high faces of periodic axes copies of the low ones', moved. Errors: geometry (with the
// yarn), limit.
Result<CellTriangles> mesh_surfaces(const CellShape& shape, const CellCurves& curves, const SizeField& field,
                                    int threads, CellNodes& nodes);

}  // namespace selvage::fem
