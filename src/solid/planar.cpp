#include "solid/planar.h"

#include "core/module.h"
#include "solid/check.h"

namespace selvage::solid {

Result<const CgalModule*> cgal_module() {
  Result<const void*> table = open_module("cgal", "selvage_cgal");
  if (!table) return table.error();
  return static_cast<const CgalModule*>(*table);
}

Result<PlanarTriangles> triangulate(std::span<const Vec2> points, std::span<const PlanarSegment> segments) {
  Result<const CgalModule*> module = cgal_module();
  if (!module) return module.error();
  for (const Vec2& point : points)
    if (!point.allFinite()) return error(Kind::geometry, "a coordinate is not a finite number");
  return (*module)->triangulate(points, segments);
}

}  // namespace selvage::solid
