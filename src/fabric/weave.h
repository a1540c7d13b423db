// The construction `weave` (formats/txt/README.md): warp i along x at y = (i - 1/2) pitch(warp), weft j along
// y at x = (j - 1/2) pitch(weft), about z = 0. Yarns that cross are twice the tolerance apart, so that their
// modelled tubes do not overlap; in a jammed cloth, which has no room for that, they touch.
#pragma once

#include <memory>

#include "fabric/plan.h"

namespace selvage::fabric {

// Errors: at their lines: a draft that cannot be, pitches too small for the sections (with the smallest
// ones), levels of binders that are not there. `fabric` and `weave` outlive the construction; warnings (yarns
// of one system wider than their pitch) go to `diagnostics`.
Result<std::unique_ptr<Construction>> make_weave(const Fabric& fabric, const Weave& weave,
                                                 Diagnostics& diagnostics);

}  // namespace selvage::fabric
