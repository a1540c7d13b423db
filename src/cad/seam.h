// Closed surfaces, and where they are cut open.
#pragma once

#include "cad/model.h"

namespace selvage::cad {

// Do both ends of a direction of the surface lie on each other?
bool closes(const nurbs::Surface& surface, bool in_u);

// A face whose boundary in parameters leaves the range of its surface, in a direction in which that is closed
// and the boundary does not go round: the surface is cut open in the middle of the gap that the boundary
// leaves, at whose parameters it then lies. The same points, by as many joined pieces; where the cut was,
// knots of full multiplicity. Any other face stays as it is.
Face with_seam_in_gap(Face face);

}  // namespace selvage::cad
