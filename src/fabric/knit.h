// The construction `knit` (formats/txt/README.md).
#pragma once

#include <memory>

#include "fabric/plan.h"

namespace selvage::fabric {

struct BuildOptions;

// The loops are moved so far that nothing overlaps, or as published. Errors: at their lines. `fabric` and
// `knit` outlive the construction; warnings go to `diagnostics`.
Result<std::unique_ptr<Construction>> make_knit(const Fabric& fabric, const Knit& knit,
                                                const BuildOptions& options, Diagnostics& diagnostics);

}  // namespace selvage::fabric
