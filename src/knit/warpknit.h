// The construction `warpknit`.
#pragma once

#include "fabric/plan.h"

namespace selvage::fabric {

// Errors, those of a lapping in its text: malformed, an overlap across more than one needle, a bar that knits
// nowhere, pitches too small for the yarns (the smallest one is named).
Make<Warpknit> make_warpknit;

}  // namespace selvage::fabric
