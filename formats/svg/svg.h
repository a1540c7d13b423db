// SVG 1.1: garment pieces as a drawing at true scale. README.md in this folder.
#pragma once

#include "formats/format.h"

namespace selvage::formats::svg {

// Extension .svg; recognised by `<svg` among the first bytes. Writer of curves only.
const Descriptor& descriptor();

}  // namespace selvage::formats::svg
