// The `edit` lines of a fabric, applied to the centre line that they name.
#pragma once

#include <string_view>

#include "core/diagnostics.h"
#include "fabric/model.h"
#include "yarn/path.h"

namespace selvage::fabric {

// Applies every edit of this yarn, in file order. Errors: at the edit's line.
Status apply_edits(const Fabric& fabric, std::string_view yarn, yarn::CentreLine& line);

}  // namespace selvage::fabric
