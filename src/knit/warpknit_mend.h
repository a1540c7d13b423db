// The loops of a warp knit moved apart (mend.h): overlaps that their dimensions leave where legs, feet and
// underlaps of several bars pass each other.
#pragma once

#include <optional>
#include <vector>

#include "knit/mend.h"
#include "knit/warpknit_points.h"

namespace selvage::fabric {

struct WarpknitPiece {
  std::vector<Bar> bars;
  Measures measures;
  long long first_course = 0, last_course = 0;  // the last one is the first that is not knitted
};

struct LoopMending {
  LoopMoves moves;
  Mending mending;
};

// Moves of data points, of every repeat of the lappings alike, after which all yarns are `gap` apart (on
// their centre lines, less half of their thicknesses), or as near to that as can be: Mending::missing. Solved
// on a piece of the cloth that shows every repeat with its neighbours. None: the repeat is too long for that
// (more than 30 000 data points). Errors: as points_of_bar.
Result<std::optional<LoopMending>> mend_loops(const WarpknitPiece& cloth, double gap);

}  // namespace selvage::fabric
