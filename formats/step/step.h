// STEP AP242 or AP214: each yarn a manifold solid with its name and colour. README.md says what stands in the
// file.
#pragma once

#include "formats/format.h"

namespace selvage::formats::step {

const Descriptor& descriptor();

}  // namespace selvage::formats::step
