// Abaqus and CalculiX input deck
#pragma once

#include "formats/format.h"

namespace selvage::formats::inp {

const Descriptor& descriptor();

}  // namespace selvage::formats::inp
