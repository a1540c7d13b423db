#include "solid/brep.h"

#include "core/module.h"

namespace selvage::solid {

Result<const OcctModule*> occt_module() {
  Result<const void*> table = open_module("occt");
  if (!table) return table.error();
  return static_cast<const OcctModule*>(*table);
}

Result<std::vector<BrepCheck>> check_breps(std::span<const yarn::Body> bodies) {
  Result<const OcctModule*> module = occt_module();
  if (!module) return module.error();
  return (*module)->check(bodies);
}

}  // namespace selvage::solid
