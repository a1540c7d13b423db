// The colours of values, of pictures and pages: blue through green to yellow, even in lightness.
#pragma once

#include <array>

#include "yarn/body.h"

namespace selvage::view {

// An approximation of viridis (S. van der Walt, N. Smith 2015) by its values at ninths, between which the
// bytes are mixed.
inline constexpr std::array<yarn::Color, 10> color_scale = {{{68, 1, 84},
                                                             {72, 40, 120},
                                                             {62, 74, 137},
                                                             {49, 104, 142},
                                                             {38, 130, 142},
                                                             {31, 158, 137},
                                                             {53, 183, 121},
                                                             {109, 205, 89},
                                                             {180, 222, 44},
                                                             {253, 231, 37}}};
inline constexpr yarn::Color color_of_none{153, 153, 153};  // of values that are none

// `share`: 0 the least value, 1 the largest; what is beyond has the end's colour. Not a number:
// color_of_none.
yarn::Color scale_color(double share);

}  // namespace selvage::view
