// Gmsh mesh 4.1
#pragma once

#include "formats/format.h"

namespace selvage::formats::msh {

const Descriptor& descriptor();

}  // namespace selvage::formats::msh
