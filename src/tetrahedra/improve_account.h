// What improve() could not do, and why.
#pragma once

#include <vector>

#include "tetrahedra/improve.h"
#include "tetrahedra/tet_complex.h"

namespace selvage::fem {

// The cells below `target` (degrees), numbered in their order without those that were taken out.
std::vector<BelowTarget> below_target(const TetComplex& complex, double target);

}  // namespace selvage::fem
