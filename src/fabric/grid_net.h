// The text's grid as what yarn/grid.h takes.
#pragma once

#include "fabric/model.h"
#include "yarn/grid.h"

namespace selvage::fabric {

// `yarn_closed`: the yarn's own word `closed`.
yarn::GridNet net_of(const Grid& grid, bool yarn_closed);

}  // namespace selvage::fabric
