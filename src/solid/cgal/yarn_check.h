// One yarn: is its skin a closed, valid solid?
#pragma once

#include "solid/check.h"
#include "solid/tessellation.h"

namespace selvage::solid {

// Never throws; a refusal of CGAL or of the tessellation is a defect of the yarn.
YarnCheck check_yarn(const yarn::Body& body, const CheckOptions& options);

}  // namespace selvage::solid
