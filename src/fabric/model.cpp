#include "fabric/model.h"

#include <algorithm>

#include "core/overloaded.h"
#include "fabric/fibres.h"

namespace selvage::fabric {

double LinearDensity::tex() const {
  switch (measure) {
    case Measure::tex:
      return value;
    case Measure::dtex:
      return value / 10.0;
    case Measure::denier:
      return value / 9.0;
    case Measure::nm:
      return 1000.0 / value;
    // English cotton count: 840-yard hanks a pound; 1000 g/km over (840 * 0.9144 m / 453.59237 g).
    case Measure::ne:
      return 453.59237e3 / (840.0 * 0.9144) / value;
  }
  return value;
}

namespace {

template <class T>
void override_with(std::optional<T>& base, const std::optional<T>& own) {
  if (own) base = own;
}

}  // namespace

Yarn yarn_like(const yarn::Body& body) {
  Yarn yarn;
  yarn.name = body.name;
  yarn.place = body.place;
  yarn.group = body.group;
  yarn.role = body.role;
  return yarn;
}

const Thread* Fabric::find_thread(std::string_view name) const {
  return find_named(threads, name);
}
const Material* Fabric::find_material(std::string_view name) const {
  const Material* const own = find_named(materials, name);
  return own != nullptr ? own : find_fibre(name);
}

namespace {

const Material* find_in_blocks(const Fabric& fabric, std::string_view name) {
  for (const NamedBlock& block : fabric.blocks) {
    if (const Material* const own = find_named(block.fabric->materials, name)) return own;
    if (const Material* const deeper = find_in_blocks(*block.fabric, name)) return deeper;
  }
  return nullptr;
}

}  // namespace

const Material* Fabric::find_material_anywhere(std::string_view name) const {
  if (const Material* const own = find_named(materials, name)) return own;
  if (const Material* const inside = find_in_blocks(*this, name)) return inside;
  return find_fibre(name);
}

namespace {

void take_from_material(Thread& thread, const Fabric& fabric) {
  const Material* const material = thread.material ? fabric.find_material(*thread.material) : nullptr;
  thread.material_density = material != nullptr ? material->density : std::nullopt;
  thread.material_packing = material != nullptr ? material->packing : std::nullopt;
}

}  // namespace

void Fabric::tell_threads_their_materials() {
  for (Thread& thread : threads) take_from_material(thread, *this);
}

Thread resolved_thread(const Fabric& fabric, const Yarn& yarn) {
  const Thread* named = fabric.find_thread(yarn.thread);
  Thread thread = named != nullptr ? *named : Thread{};
  const Thread& own = yarn.own;
  override_with(thread.linear_density, own.linear_density);
  override_with(thread.density, own.density);
  override_with(thread.packing, own.packing);
  override_with(thread.diameter, own.diameter);
  override_with(thread.section, own.section);
  override_with(thread.twist, own.twist);
  override_with(thread.plies, own.plies);
  override_with(thread.filaments, own.filaments);
  override_with(thread.color, own.color);
  override_with(thread.material, own.material);
  take_from_material(thread, fabric);
  return thread;
}

std::vector<std::string> threads_of(const Item& item) {
  using Names = std::vector<std::string>;
  return std::visit(Overloaded{
                        [](const Yarn&) { return Names(); },
                        [](const Weave& weave) {
                          Names names = weave.warp.threads;
                          names.insert(names.end(), weave.weft.threads.begin(), weave.weft.threads.end());
                          for (const Binder& binder : weave.binders) names.push_back(binder.thread);
                          for (const WarpColumn& column : weave.columns)
                            for (const StackedWarp& warp : column)
                              if (!warp.thread.empty()) names.push_back(warp.thread);
                          if (weave.pile && !weave.pile->thread.empty()) names.push_back(weave.pile->thread);
                          return names;
                        },
                        [](const Knit& knit) {
                          Names names = knit.threads;
                          if (!knit.plating.empty()) names.push_back(knit.plating);
                          return names;
                        },
                        [](const Warpknit& warpknit) {
                          Names names = {warpknit.thread};
                          for (const WarpknitBar& bar : warpknit.bars) names.push_back(bar.thread);
                          return names;
                        },
                        [](const Braid& braid) {
                          return Names{braid.thread, braid.axial_thread};
                        },
                        [](const Piece&) { return Names(); },
                        [](const Use&) { return Names(); },
                    },
                    item);
}

}  // namespace selvage::fabric
