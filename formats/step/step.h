// STEP AP242 or AP214, manifold solids
#pragma once

#include "formats/format.h"

namespace selvage::formats::step {

const Descriptor& descriptor();

}  // namespace selvage::formats::step
