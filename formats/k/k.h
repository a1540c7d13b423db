// LS-DYNA keyword file
#pragma once

#include "formats/format.h"

namespace selvage::formats::k {

const Descriptor& descriptor();

}  // namespace selvage::formats::k
