// The construction `weave` (formats/txt/README.md): warp i along x at y = (i - 1/2) pitch(warp), weft j along
// y at x = (j - 1/2) pitch(weft), about z = 0. Yarns that cross keep 1 % of their thickness (or
// BuildOptions::gap) and twice the tolerance apart; in a jammed cloth, which has no room for that, they are
// made thinner (weave_fit.h). As published: they are twice the tolerance apart at the crossing itself, and
// touch in a jammed cloth.
#pragma once

#include <memory>

#include "fabric/plan.h"

namespace selvage::fabric {

struct BuildOptions;

// Errors: at their lines: a draft that cannot be, pitches too small for the sections (with the smallest
// ones), levels of binders that are not there. `fabric` and `weave` outlive the construction; warnings (yarns
// of one system wider than their pitch, or without room to pass each other) go to `diagnostics`.
Result<std::unique_ptr<Construction>> make_weave(const Fabric& fabric, const Weave& weave,
                                                 const BuildOptions& options, Diagnostics& diagnostics);

}  // namespace selvage::fabric
