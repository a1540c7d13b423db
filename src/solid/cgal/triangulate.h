// solid/planar.h with CGAL.
#pragma once

#include "solid/planar.h"

namespace selvage::solid {

// Throws what CGAL throws.
Result<PlanarTriangles> triangulate_with_cgal(std::span<const Vec2> points,
                                              std::span<const PlanarSegment> segments);

}  // namespace selvage::solid
