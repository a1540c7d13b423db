#include "solid/check.h"

#include "core/module.h"

namespace selvage::solid {

Result<const CgalModule*> cgal_module() {
  Result<const void*> table = open_module("cgal", "selvage_cgal");
  if (!table) return table.error();
  return static_cast<const CgalModule*>(*table);
}

Result<SolidCheck> check_solids(std::span<const yarn::Body> bodies, const CheckOptions& options) {
  Result<const CgalModule*> module = cgal_module();
  if (!module) return module.error();
  return (*module)->check(bodies, options);
}

}  // namespace selvage::solid
