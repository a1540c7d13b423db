// A yarn as what a CAD file would hold of it.
#pragma once

#include "cad/model.h"
#include "yarn/body.h"

namespace selvage::cad {

// The body's surface, then its end faces (a planar one is a bilinear surface trimmed by the end curve). Kind
// `solid` when it is closed, else `surfaces`. Faces are reversed so that their outsides point out of the
// yarn.
Part part_of(const yarn::Body& body);

}  // namespace selvage::cad
