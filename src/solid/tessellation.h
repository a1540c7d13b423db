// A yarn's skin as triangles: what the checks look at. Flat ends are triangulated by solid/planar.h.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/diagnostics.h"
#include "yarn/body.h"

namespace selvage::solid {

// Of a yarn or of a whole fabric.
inline constexpr double max_triangles = 1e8;

enum class Skin : std::uint8_t { side, start, end };

// Triangles run counter-clockwise seen from outside. An end face shares its boundary vertices with the body
// exactly where the two surfaces do (within `sewing_gap`); where they do not it keeps its own, so that a gap
// stays a gap.
struct Tessellation {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Skin> skin;  // one a triangle
  std::vector<Vec2>
      sites;  // one a vertex: (u, v) on the body's surface; NaN for a vertex that only an end face has
};

// The largest distance at which two points of a joint count as one: rounding of the coordinates
// (16 ulp of the yarn's largest coordinate), and for a yarn that was read what its file resolves, but no more
// than 1e-8 of that coordinate.
double sewing_gap(const yarn::Body& body);

// Points so dense that no triangle is farther than `chord` (file units, > 0) from the surface: 1/8 (du^2
// |S_uu| + 2 du dv |S_uv| + dv^2 |S_vv|) by Filip, Magedson and Markot (1986), with the second derivatives
// from differences of surface points at four places a knot span. Every knot line is an edge line. Errors:
// geometry (an empty or a non-finite surface, an end whose outline crosses itself), limit (more than
// max_triangles), and of the module where an end is flat. A yarn without ends (style none) that is not
// closed is tessellated open. No edge on the side, but for diagonals, is longer than `longest`, to a few
// percent.
Result<Tessellation> tessellate(const yarn::Body& body, double chord,
                                double longest = std::numeric_limits<double>::infinity());

// Enclosed volume of outward triangles (divergence theorem).
double volume(const Tessellation& skin);

// Area of all triangles.
double area(const Tessellation& skin);

}  // namespace selvage::solid
