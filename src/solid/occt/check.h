// OpenCASCADE's judgement on yarns; the function of solid/brep.h. Internal to the module selvage_occt.
#pragma once

#include <span>
#include <vector>

#include "solid/brep.h"

namespace selvage::solid::occt {

Result<std::vector<BrepCheck>> check(std::span<const yarn::Body> bodies);

}  // namespace selvage::solid::occt
