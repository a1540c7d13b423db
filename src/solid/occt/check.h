// OpenCASCADE's judgement on yarns; the function of solid/brep.h. Internal to the module selvage_occt.
#pragma once

#include <span>
#include <vector>

#include "solid/brep.h"

namespace selvage::solid::occt {

Result<std::vector<BrepCheck>> check(std::span<const yarn::Body> bodies);

// The same of one yarn without its volume, which takes most of the time: what the writer asks before it takes
// a yarn.
BrepCheck check_topology(const yarn::Body& body);

}  // namespace selvage::solid::occt
