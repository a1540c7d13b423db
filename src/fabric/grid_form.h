// A yarn's surface as the rows and words of a grid.
#pragma once

#include "fabric/model.h"
#include "yarn/body.h"

namespace selvage::fabric {

// The grid whose surface, and the corners of whose end patches, are the body's to the bit. Degrees, knots and
// corners are given only where the grid's defaults are others.
Grid grid_of(const yarn::Body& body);

}  // namespace selvage::fabric
