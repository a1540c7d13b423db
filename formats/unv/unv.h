// I-DEAS universal file
#pragma once

#include "formats/format.h"

namespace selvage::formats::unv {

const Descriptor& descriptor();

}  // namespace selvage::formats::unv
