#include "solid/planar.h"

#include "solid/check.h"

namespace selvage::solid {

Result<PlanarTriangles> triangulate(std::span<const Vec2> points, std::span<const PlanarSegment> segments) {
  Result<const CgalModule*> module = cgal_module();
  if (!module) return module.error();
  for (const Vec2& point : points)
    if (!point.allFinite()) return error(Kind::geometry, "a coordinate is not a finite number");
  return (*module)->triangulate(points, segments);
}

}  // namespace selvage::solid
