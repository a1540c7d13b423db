// Colours of yarns that nobody gave one: of pictures and pages.
#pragma once

#include <cstddef>

#include "yarn/body.h"

namespace selvage::view {

// Of the yarn of this number among those that are shown: every second one is a little lighter, so that
// neighbours can be told apart.
yarn::Color role_color(yarn::Role role, std::size_t number);

}  // namespace selvage::view
