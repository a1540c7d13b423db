// Colours of yarns that nobody gave one.
#pragma once

#include <cstddef>

#include "yarn/body.h"

namespace selvage::yarn {

// Of the yarn of this number among those that are shown: every second one is a little lighter, so that
// neighbours can be told apart. In files those of Z twist are the lighter ones.
Color role_color(Role role, std::size_t number);

// Of regions of meshes, one by one: hues a golden section of the circle apart; and of the matrix.
Color hue_color(std::size_t index);
inline constexpr Color matrix_color{196, 199, 198};

}  // namespace selvage::yarn
