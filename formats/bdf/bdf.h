// Nastran bulk data file
#pragma once

#include "formats/format.h"

namespace selvage::formats::bdf {

const Descriptor& descriptor();

}  // namespace selvage::formats::bdf
