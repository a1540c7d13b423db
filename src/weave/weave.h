// The construction `weave`.
#pragma once

#include "fabric/plan.h"

namespace selvage::fabric {

// Errors: a draft that cannot be, pitches too small for the sections (with the smallest ones), levels of
// binders that are not there. Warnings: yarns of one system wider than their pitch, or without room to pass
// each other.
Make<Weave> make_weave;

}  // namespace selvage::fabric
