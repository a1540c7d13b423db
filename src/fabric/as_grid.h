// A finished yarn as a `grid` of Fabric TXT.
#pragma once

#include "fabric/model.h"

namespace selvage::fabric {

struct GridYarn {
  Yarn yarn;               // its shape is a Grid, with only as many words as are needed
  bool keeps_ends = true;  // building it gives the same end faces, to the bit
};

// Building the yarn (without other options) gives the body's surface to the bit, and its end faces where they
// are those that this program makes; others are made anew.
GridYarn as_grid(const yarn::Body& body);

// The same of a yarn whose shape is a body (ReadBody), with the thread and the statements of its own that it
// has in the fabric.
GridYarn as_grid(const Fabric& fabric, const Yarn& yarn);

// The centre line that the grid's yarn has: the middles of its rows. Where a body was not swept along a path
// it is as good as any, and with it a yarn measures the same before and after it is written.
nurbs::Curve grid_axis(const yarn::Body& body);

}  // namespace selvage::fabric
