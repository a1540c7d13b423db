// IGES 5.3, B-spline surfaces or solids
#pragma once

#include "formats/format.h"

namespace selvage::formats::iges {

const Descriptor& descriptor();

}  // namespace selvage::formats::iges
