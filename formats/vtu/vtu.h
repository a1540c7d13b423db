// VTK unstructured grid
#pragma once

#include "formats/format.h"

namespace selvage::formats::vtu {

const Descriptor& descriptor();

}  // namespace selvage::formats::vtu
