// Points of yarns' surfaces moved along them, for the tetrahedra on both sides.
#pragma once

#include <cstddef>

#include "tetrahedra/block.h"

namespace selvage::fem {

// What improve() leaves where it is: the skin's points, of which those inside one yarn's smooth side may
// slide. Each is moved, as PointPlace does it, such that the smallest dihedral angle at it grows, up to
// `goal` degrees; never farther than 0.4 of its shortest edge. `on_surface`: it stays on the yarn's surface;
// else in the plane across the sum of the areas of the triangles round it, so that the volumes of the yarn
// and of what is around it stay as they are, to rounding. Triangles keep their corners. Where points stand on
// the surfaces (CellNodes::places) is brought up to date. Returned: how many were moved.
std::size_t slide_points(TetMesh& tets, Block& block, double goal, bool on_surface);

}  // namespace selvage::fem
