// A helix as the rows of a path.
#pragma once

#include <cstdint>

#include "fabric/model.h"

namespace selvage::fabric {

// Rows of drawn_helix; the largest number that there is where that is too small.
std::uint64_t helix_rows(const Helix& helix, double tolerance);

// The yarn, whose shape is a helix, with a path instead: rows at equal steps and the derivatives at both
// ends, so that the cubic through them is nowhere farther than a tenth of the tolerance from the helix (C. A.
// Hall and W. W. Meyer, Optimal error bounds for cubic spline interpolation, J. Approx. Theory 16 (1976):
// 5/384 of the step's fourth power and the fourth derivative).
Yarn drawn_helix(const Yarn& yarn, double tolerance);

}  // namespace selvage::fabric
