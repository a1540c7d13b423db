// A yarn's surface as triangles of about equal edges, fit for TetGen: rows of vertices round the section,
// strips of triangles between them, and a triangulated cap at each end that shares the row's vertices.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"
#include "fem/end_cap.h"
#include "fem/worker.h"
#include "yarn/body.h"

namespace selvage::fem {

// The smallest width of the body's sections over all directions across the path; sections smaller than a
// tenth of the largest one are passed over (a yarn that runs to a point). File units.
double smallest_section_extent(const yarn::Body& body);

struct SurfaceMesh {
  std::vector<Vec3> points;      // file units; the side's first
  std::vector<Vec2> parameters;  // (u, v) of each point of the side; u in [first, last), v likewise on a ring
  std::vector<Triangle> triangles;  // counter-clockwise seen from outside: side, start, end
  std::size_t side_triangles = 0, start_triangles = 0, end_triangles = 0;
  std::vector<std::uint32_t> start_points, end_points;  // on the end faces, the rim first; empty for a ring
  std::optional<EndCap> start_cap, end_cap;             // they look into the body
  double coarsest = 0;  // the longest spacing of rows that was used: below `size` where the section is small

  [[nodiscard]] std::span<const Triangle> side() const { return std::span(triangles).first(side_triangles); }
  [[nodiscard]] std::span<const Triangle> start() const {
    return std::span(triangles).subspan(side_triangles, start_triangles);
  }
  [[nodiscard]] std::span<const Triangle> end() const { return std::span(triangles).last(end_triangles); }
};

// Edges are about `size` long (> 0, file units), shorter where the section bends within it (at least 8 round,
// about 9 for a full turn, not below a third of `size` for that reason alone) or changes over it. Vertices
// stand on the seam and on every sharp crest of the surface; sections that are the same get the same
// vertices, so that a straight yarn's mesh is a prism. Points of the caps lie on the end face's surface or,
// where it is a plane or missing, on the mean plane of the rim (blended with the rim's own height). Errors:
// geometry (not finite, an end outline that crosses itself), limit (more than 2 10^8 triangles). `body`
// outlives the result.
Result<SurfaceMesh> mesh_surface(const yarn::Body& body, double size);

}  // namespace selvage::fem
