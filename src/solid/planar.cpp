#include "solid/planar.h"

#include "core/module.h"
#include "solid/check.h"

namespace selvage::solid {

Result<const CgalModule*> cgal_module() {
  return module_table<CgalModule>("cgal", "selvage_cgal");
}

Result<PlanarTriangles> triangulate(std::span<const Vec2> points, std::span<const PlanarSegment> segments) {
  for (const Vec2& point : points)
    if (!point.allFinite()) return error(Kind::geometry, "a coordinate is not a finite number");
  return call(cgal_module(), &CgalModule::triangulate, points, segments);
}

}  // namespace selvage::solid
