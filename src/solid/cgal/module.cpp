#include <exception>
#include <mutex>

#include "core/parallel.h"
#include "solid/cgal/overlaps.h"
#include "solid/cgal/verdict.h"
#include "solid/cgal/yarn_check.h"
#include "solid/check.h"

namespace selvage::solid {

namespace {

Result<SolidCheck> check(std::span<const yarn::Body> bodies, const CheckOptions& options) try {
  const std::size_t steps = bodies.size() * (options.overlaps ? 2 : 1);
  std::size_t done = 0;
  std::mutex guard;
  const auto step = [&] {
    if (!options.progress) return;
    const std::lock_guard lock(guard);
    options.progress(++done, steps);
  };
  SolidCheck result;
  result.yarns.resize(bodies.size());
  std::vector<Tessellation> skins(bodies.size());
  std::vector<Skinned> skinned(bodies.size());
  for_each_index(bodies.size(), options.threads, [&](std::size_t i) {
    const double chord = bodies[i].surface.is_empty() ? options.chord : chord_of(bodies[i], options);
    Checked checked = check_yarn(bodies[i], chord);
    result.yarns[i] = std::move(checked.check);
    if (options.overlaps) skins[i] = std::move(checked.skin);
    skinned[i] = {&bodies[i], &skins[i], chord};
    step();
  });
  if (!options.overlaps) return result;
  Neighbourhood found = find_overlaps(skinned, options.threads, step);
  result.overlaps = std::move(found.overlaps);
  result.min_gap = found.min_gap;
  return result;
} catch (const std::exception& failure) {
  return error(Kind::internal, std::string("the check of the solids failed: ") + failure.what());
}

}  // namespace

}  // namespace selvage::solid

extern "C" __attribute__((visibility("default"))) const void* selvage_cgal() {
  static const selvage::solid::CgalModule table = {selvage::solid::cgal_version(), &selvage::solid::check};
  return &table;
}
