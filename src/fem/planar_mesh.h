// Triangles inside a simple polygon in the plane, whose edges are kept as they are.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/vec.h"

namespace selvage::fem {

struct PlanarMesh {
  std::vector<Vec2> points;                             // the polygon's own first, then those inside
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise
};

// Constrained Delaunay triangulation of a counter-clockwise simple polygon with a hexagonal lattice of points
// `spacing` apart inside, kept off the rim and smoothed. Ear clipping, insertion and Lawson's flips (Lawson
// 1977); quadratic in the number of rim points. Nothing comes back for a polygon that crosses itself or
// encloses nothing.
std::optional<PlanarMesh> mesh_polygon(std::span<const Vec2> rim, double spacing);

}  // namespace selvage::fem
