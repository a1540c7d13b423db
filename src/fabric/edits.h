// The `edit` lines of a fabric, applied to the centre line that they name: methods.md, 4 (nurbs/edit.h).
#pragma once

#include <string_view>

#include "core/diagnostics.h"
#include "fabric/model.h"
#include "yarn/path.h"

namespace selvage::fabric {

// Applies every edit of this yarn, in file order. Knots, and with them the parameters at which section sizes
// stand, stay; the curve is rational after an edit by weight. Errors (geometry), each at its edit's line: as
// nurbs/edit.h; a centre line of straights and arcs.
Status apply_edits(const Fabric& fabric, std::string_view yarn, yarn::CentreLine& line);

}  // namespace selvage::fabric
