// A scale bar: a round length (1, 2 or 5 times a power of ten) and its unit, at the foot of a picture, below
// what it shows. Of metric units the one in which the length is told shortly: µm, mm or m.
#pragma once

#include "core/units.h"
#include "view/picture.h"

namespace selvage::view {

// How many rows of pixels it takes of a picture of this size: some 5 % of its smaller side. 0: that picture
// is too small to read one.
int scale_bar_rows(int width, int height);

// Adds so many rows to the picture, of this background; the bar is at most a quarter as long as the picture
// is wide.
void add_scale_bar(Picture& picture, int rows, Unit unit, const yarn::Color& background);

}  // namespace selvage::view
