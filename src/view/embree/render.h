// The picture, tile by tile. Internal to the module selvage_embree.
#pragma once

#include "view/picture.h"

namespace selvage::view::embree {

Result<Picture> render_yarns(std::span<const yarn::Body> bodies, const PictureOptions& options);

}  // namespace selvage::view::embree
