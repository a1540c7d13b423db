// Where the sharp crests of yarns go through the faces of a cell.
#pragma once

#include <cstddef>
#include <vector>

#include "surface_mesh/cell_curves.h"
#include "surface_mesh/size_field.h"

namespace selvage::fem {

// On an arc of the cut.
struct CrestCrossing {
  double along = 0;  // of the arc's length
  double crest = 0;  // the crest's u, as it goes on past the seam along the arc
  // The face cuts the crest at a slant, so that the yarn ends there in a needle: the first edge of the arc on
  // either side of the crossing, file units; 0: no slant.
  double first = 0;
};

struct CrestTips {
  std::vector<std::vector<CrestCrossing>> of_arcs;  // in the order of the cut, along each
  // Edges beside needles are no longer than what the yarn is thick there allows: a prism between its two
  // sides has the angle at which its height is seen along an edge.
  std::vector<SizeField::Bound> bounds;
};

CrestTips find_crest_tips(const CellShape& shape, const SizeRules& rules);

}  // namespace selvage::fem
