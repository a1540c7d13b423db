// Yarns whose section changes its shape along the path: ../shared/references 002, whose bodies are quadratic
// round sections of measured points and cubic along the yarn.
#pragma once

#include "core/diagnostics.h"
#include "fabric/model.h"

namespace selvage::fabric {

// Every yarn whose path rows name outlines becomes the grid of a surface that goes through the section of
// each row: the closed quadratic over the outline's points, across the centre line, scaled and turned as the
// row says; each control point runs along the cubic through its places in the rows, over the parameters of
// the path, rational by the rows' weights. A row without an outline has what lies between those of its
// neighbours, by the path's parameter. What is wrong goes to `diagnostics`, at its line: malformed (outlines
// of different numbers of points, a form of path without data points), geometry (as make_centre_line,
// FrameField::make).
void loft(Fabric& fabric, Diagnostics& diagnostics);

}  // namespace selvage::fabric
