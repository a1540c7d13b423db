// Constrained Delaunay triangulations in the plane, by CGAL (in the module selvage_cgal).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"

namespace selvage::solid {

// An edge that the triangulation has, with the domains on both sides of it.
struct PlanarSegment {
  std::uint32_t from = 0, to = 0;      // points
  std::int32_t left = -1, right = -1;  // domains, seen along the segment; -1: outside
};

struct PlanarTriangles {
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise, sorted by nothing but the input
  std::vector<std::int32_t> domains;                    // one a triangle, >= 0
};

// The triangles of all domains; points may lie anywhere. The same input gives the same triangles. Errors
// (geometry, `at` in the plane with z = 0): two points in one place, all on a line, segments that cross or
// pass through points, a domain that is on both sides of a segment that says otherwise.
Result<PlanarTriangles> triangulate(std::span<const Vec2> points, std::span<const PlanarSegment> segments);

}  // namespace selvage::solid
