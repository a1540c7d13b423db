// The construction `weave` (formats/txt/README.md).
#pragma once

#include <memory>

#include "fabric/plan.h"

namespace selvage::fabric {

// Errors: at their lines. `fabric` and `weave` outlive the construction; warnings go to `diagnostics`.
Result<std::unique_ptr<Construction>> make_weave(const Fabric& fabric, const Weave& weave,
                                                 Diagnostics& diagnostics);

}  // namespace selvage::fabric
