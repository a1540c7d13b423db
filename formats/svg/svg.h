// SVG 1.1: garment pieces as a drawing at true scale. README.md in this folder.
#pragma once

#include "formats/format.h"

namespace selvage::formats::svg {

// Extension .svg; recognised by `<svg` among the first bytes. Writer of curves only.
const Descriptor& descriptor();

// `text` as characters that XML 1.0 may hold, with & < > " escaped; bytes that are not UTF-8 and control
// characters become U+FFFD.
std::string xml_text(std::string_view text);

}  // namespace selvage::formats::svg
