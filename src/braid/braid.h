// The construction `braid`.
#pragma once

#include "fabric/plan.h"

namespace selvage::fabric {

Make<Braid> make_braid;

}  // namespace selvage::fabric
