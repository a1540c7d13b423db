// The construction `braid` (formats/txt/README.md).
#pragma once

#include <memory>

#include "fabric/plan.h"

namespace selvage::fabric {

struct BuildOptions;

// Errors: at their lines. `fabric` and `braid` outlive the construction; warnings go to `diagnostics`.
Result<std::unique_ptr<Construction>> make_braid(const Fabric& fabric, const Braid& braid,
                                                 const BuildOptions& options, Diagnostics& diagnostics);

}  // namespace selvage::fabric
