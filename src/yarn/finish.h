// The last step of building a yarn, the same for paths and grids.
#pragma once

#include "yarn/body.h"

namespace selvage::yarn {

// From a body with name, place, surface, axis, closed_along and quarters: finds which way its normals point,
// seals it, and measures length, volume, end area and bends. Errors (geometry): an end that cannot be sealed,
// a body without volume.
Status finish(Body& body, EndStyle ends);

// The same for a body whose end faces are there already, with their styles and surfaces (yarns that were
// read): they keep every bit, their centres and directions are found.
Status finish_as_sealed(Body& body);

}  // namespace selvage::yarn
