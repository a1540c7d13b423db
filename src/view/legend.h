// What the colours of a mesh mean: a bar of the colour scale with its values and a title, below what a
// picture shows.
#pragma once

#include <string>

#include "view/picture.h"

namespace selvage::view {

struct Legend {
  std::string title;         // what is shown, its unit
  double low = 0, high = 1;  // values of the scale's ends, low < high
};

// How many rows of pixels it takes of a picture of this size; 0: that one is too small to read it.
int legend_rows(int width, int height);

// Adds so many rows to the picture, of this background. The bar takes 7 tenths of the width, in the middle,
// and has five values, the ends among them.
void add_legend(Picture& picture, int rows, const Legend& legend, const yarn::Color& background);

}  // namespace selvage::view
