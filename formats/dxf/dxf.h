// DXF of AutoCAD 2000 (AC1015), ASCII: garment pieces as blocks. README.md in this folder.
#pragma once

#include "formats/format.h"

namespace selvage::formats::dxf {

// Extension .dxf; recognised by a first tag `0 SECTION`. Writer of curves only.
const Descriptor& descriptor();

}  // namespace selvage::formats::dxf
