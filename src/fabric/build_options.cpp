#include "fabric/build_options.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "fabric/inside.h"
#include "fabric/yarn_spec.h"

namespace selvage::fabric {

namespace {

// Blocks that were looked into are not looked into again.
void look_for_smallest(const Fabric& fabric, std::set<const Fabric*>& seen, double& smallest) {
  const auto look = [&](const std::optional<double>& size) {
    if (size) smallest = std::min(smallest, *size);
  };
  for (const Item& item : fabric.items) {
    if (const auto* yarn = std::get_if<Yarn>(&item)) look(smallest_size(fabric, *yarn));
    for (const std::string& name : threads_of(item))
      if (const Thread* thread = fabric.find_thread(name)) look(smallest_size(fabric, *thread));
    const NamedBlock* block = used_block(fabric, item);
    if (block != nullptr && seen.insert(block->fabric.get()).second)
      look_for_smallest(inside(fabric, *block), seen, smallest);
  }
}

}  // namespace

std::optional<double> smallest_section(const Fabric& fabric) {
  double smallest = std::numeric_limits<double>::infinity();
  std::set<const Fabric*> seen;
  look_for_smallest(fabric, seen, smallest);
  return std::isfinite(smallest) ? std::optional(smallest) : std::nullopt;
}

double tolerance_of(const Fabric& fabric, const BuildOptions& options) {
  if (options.tolerance > 0.0) return options.tolerance;
  if (fabric.tolerance) return *fabric.tolerance;
  return smallest_section(fabric).value_or(0.0) / 1000.0;
}

}  // namespace selvage::fabric
