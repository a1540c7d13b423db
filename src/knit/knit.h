// The construction `knit`: weft knits.
#pragma once

#include "fabric/plan.h"

namespace selvage::fabric {

// The loops are moved so far that nothing overlaps, or as published.
Make<Knit> make_knit;

}  // namespace selvage::fabric
