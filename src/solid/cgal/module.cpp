
#include "core/module.h"
#include "core/parallel.h"
#include "solid/cgal/triangulate.h"
#include "solid/cgal/verdict.h"
#include "solid/cgal/yarn_check.h"
#include "solid/check.h"

namespace selvage::solid {

namespace {

SolidCheck check_all(std::span<const yarn::Body> bodies, const CheckOptions& options) {
  SolidCheck result;
  result.yarns.resize(bodies.size());
  const auto check_one = [&](std::size_t i) {
    const double chord = bodies[i].surface.is_empty() ? options.chord : chord_of(bodies[i], options);
    result.yarns[i] = check_yarn(bodies[i], chord);
  };
  for_each_index(bodies.size(), options.threads, check_one, options.progress);
  return result;
}

Result<SolidCheck> check(std::span<const yarn::Body> bodies, const CheckOptions& options) {
  return guarded_by_module("the check of the solids failed",
                           [&]() -> Result<SolidCheck> { return check_all(bodies, options); });
}

Result<PlanarTriangles> triangulate_safely(std::span<const Vec2> points,
                                           std::span<const PlanarSegment> segments) {
  return guarded_by_module("the triangulation failed",
                           [&] { return triangulate_with_cgal(points, segments); });
}

}  // namespace

}  // namespace selvage::solid

extern "C" __attribute__((visibility("default"))) const void* selvage_cgal() {
  static const selvage::solid::CgalModule table = {selvage::solid::cgal_version(), &selvage::solid::check,
                                                   &selvage::solid::triangulate_safely};
  return &table;
}
