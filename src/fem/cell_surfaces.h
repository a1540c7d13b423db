// Everything that bounds and parts the regions of a unit cell, as triangles that share their nodes.
#pragma once

#include <vector>

#include "fem/cell_curves.h"
#include "fem/end_cap.h"
#include "fem/worker.h"

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

  void add(const Triangle& triangle, const Sides& both, Part part) {
    triangles.push_back(triangle);
    sides.push_back(both);
    parts.push_back(part);
  }
};

struct SurfaceOptions {
  std::size_t most_triangles = 50'000'000;
  bool matrix = true;  // else there is nothing beside the yarns
};

// The yarns' surfaces inside the box, node places on the B-spline surface; sharp crests stay edges. Errors:
// geometry (with the yarn), limit.
Status add_yarn_surfaces(const CellShape& shape, const CellCurves& curves, const SizeField& field,
                         const SurfaceOptions& options, int threads, CellNodes& nodes, CellTriangles& result);

// The faces of the box; on high faces of periodic axes copies of the low ones', moved. Errors: geometry,
// limit.
Status add_box_faces(const CellShape& shape, const CellCurves& curves, const SizeField& field,
                     const SurfaceOptions& options, CellNodes& nodes, CellTriangles& result);

}  // namespace selvage::fem
