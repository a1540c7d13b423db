// Whether a user's own loops make a cloth: each closes onto its neighbour, and the loops of a course go
// through those that their needles hold.
#pragma once

#include <vector>

#include "core/diagnostics.h"
#include "knit/loop.h"
#include "knit/warpknit_points.h"
#include "nurbs/interpolate.h"

namespace selvage::fabric {

// How often a line goes through a loop that a chord closes: 1 for each time from the back (-z) to the face,
// -1 for each time from the face to the back. Counted on the triangles from the loop's middle to its sides.
int passages(const std::vector<Vec3>& loop, const std::vector<Vec3>& line);

// The way up to the highest point and the way down go through `held` and back, from the back (side 1) or from
// the face (side -1).
bool interloops(const std::vector<Vec3>& held, const std::vector<Vec3>& loop, double side);

// Errors, at the block of the points: a sign of the chart without points (geometry); a loop that does not end
// where its neighbour begins; a loop that does not go through the one below it.
Status check_own_loops(const Knit& knit, const KnitField& field);

// The same for the loops of the bars of a warp knit.
Status check_own_loops(const std::vector<Bar>& bars, const Measures& measures);

}  // namespace selvage::fabric
