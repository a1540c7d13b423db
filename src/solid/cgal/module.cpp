
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
  const auto check_one = [&](std::size_t i) { result.yarns[i] = check_yarn(bodies[i], options); };
  // What is sound is sound wherever it stands; defects are told of each yarn.
  const std::vector<std::size_t> first = yarn::first_of_shape(bodies);
  std::vector<std::size_t> distinct, copies;
  for (std::size_t i = 0; i < bodies.size(); ++i) (first[i] == i ? distinct : copies).push_back(i);
  const auto step = [&](std::size_t before) -> std::function<void(std::size_t, std::size_t)> {
    return [&options, before, total = bodies.size()](std::size_t done, std::size_t /*of*/) {
      if (options.progress) options.progress(before + done, total);
    };
  };
  for_each_index(
      distinct.size(), options.threads, [&](std::size_t k) { check_one(distinct[k]); }, step(0));
  const auto take_over = [&](std::size_t k) {
    const YarnCheck& known = result.yarns[first[copies[k]]];
    if (known.defects.empty())
      result.yarns[copies[k]] = known;
    else
      check_one(copies[k]);
  };
  for_each_index(copies.size(), options.threads, take_over, step(distinct.size()));
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
