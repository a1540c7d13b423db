// Fabric TXT, the input language
#pragma once

#include "formats/format.h"

namespace selvage::formats::txt {

const Descriptor& descriptor();

}  // namespace selvage::formats::txt
