// One yarn cut by a box. Internal to this folder.
#pragma once

#include "cell/cut.h"

namespace selvage::cell {

// The surface is sampled by a grid of triangles that are within a quarter of the tolerance of it; on it,
// borders are found by the signs of the distances from the faces at its vertices, so that what is found hangs
// together whatever the rounding. Then every point goes onto the surface and the face themselves (by
// bisection along the grid's edges; at corners by Newton's method). Errors and notes: cut(); Piece::body is
// the caller's.
Result<Cut> trim(const yarn::Body& body, const Box3& box, double tolerance);

}  // namespace selvage::cell
