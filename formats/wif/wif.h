// Weaving information files, the exchange format of weaving programs. README.md: what is read.
#pragma once

#include "formats/format.h"

namespace selvage::formats::wif {

const Descriptor& descriptor();

}  // namespace selvage::formats::wif
