// A yarn's skin as triangles: what the checks look at. No CGAL here.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/diagnostics.h"
#include "yarn/body.h"

namespace selvage::solid {

enum class Skin : std::uint8_t { side, start, end };

// Triangles run counter-clockwise seen from outside. An end face shares its boundary vertices with the body exactly
// where the two surfaces do (within `sewing_gap`); where they do not it keeps its own, so that a gap stays a gap.
struct Tessellation {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Skin> skin;  // one a triangle
};

// The largest distance at which two points of a joint count as one: rounding of the coordinates, nothing more
// (16 ulp of the yarn's largest coordinate).
double sewing_gap(const yarn::Body& body);

// Points so dense that no triangle's plane is farther than `chord` (file units) from the surface, as estimated from the
// control net's second differences. Error (geometry): a yarn without ends (style none) that is not closed is tessellated
// open; only an empty or non-finite surface is refused.
Result<Tessellation> tessellate(const yarn::Body& body, double chord);

// Enclosed volume of outward triangles (divergence theorem).
double volume(const Tessellation& skin);

}  // namespace selvage::solid
