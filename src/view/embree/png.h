// PNG by libpng. Internal to the module selvage_embree.
#pragma once

#include "view/picture.h"

namespace selvage::view::embree {

Result<std::string> encode_png(const Picture& picture);

}  // namespace selvage::view::embree
