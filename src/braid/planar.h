// A planar braid: a tube's cloth laid flat, whose braiders run straight across it from edge to edge.
#pragma once

#include <memory>

#include "braid/shape.h"
#include "core/diagnostics.h"
#include "fabric/model.h"
#include "fabric/plan.h"

namespace selvage::fabric {

// The cloth from x = 0 to the braid's length and half its width to both sides of y = 0; with a `cell` it goes
// on beyond both by two steps. `shape` is planar and fits; `axial` where the braid has such yarns; `points`:
// data points a step, even. All outlive the construction but the shape. Errors: geometry (too short for a
// yarn), limit (more yarns than any use).
Result<std::unique_ptr<Construction>> make_planar_braid(const Fabric& fabric, const Braid& braid,
                                                        const Thread& thread, const Thread* axial,
                                                        const BraidShape& shape, int points);

}  // namespace selvage::fabric
