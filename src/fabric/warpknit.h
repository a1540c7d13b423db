// The construction `warpknit` (formats/txt/README.md).
#pragma once

#include <memory>

#include "fabric/plan.h"

namespace selvage::fabric {

// Errors: at their lines. `fabric` and `warpknit` outlive the construction; warnings go to `diagnostics`.
Result<std::unique_ptr<Construction>> make_warpknit(const Fabric& fabric, const Warpknit& warpknit,
                                                    Diagnostics& diagnostics);

}  // namespace selvage::fabric
