// Is a face just all of its surface? Many writers give every face a boundary, tubes and patches, too.
#pragma once

#include "cad/model.h"

namespace selvage::cad {

// Do the loops run along the natural border of the surface and nowhere else: once along every side, twice or
// never along a seam (two sides that coincide), and along a side without length as they like? True without
// loops. An edge is on a side by its curve in the parameters (within 1e-6 of their range), else by the one in
// space (within `tolerance`, model units, at its breakpoints and between).
bool has_natural_border(const Face& face, double tolerance);

// Takes the loops away where that is so: the face is then untrimmed, and they are its border.
bool drop_natural_border(Face& face, double tolerance);

// What counts as equal on a face of a file that claims `resolution` (file units; 0: nothing): no less than
// 1e-7 and no more than 1e-5 of the face's size.
double border_tolerance(const Face& face, double resolution);

// The natural border as a loop, counter-clockwise in the parameters, one edge a side, in space and in the
// parameters; `curve` has no points where the side has no length (below `tolerance`).
Loop natural_border(const nurbs::Surface& surface, double tolerance);

}  // namespace selvage::cad
