// One yarn: is its skin a closed, valid solid?
#pragma once

#include "solid/check.h"
#include "solid/tessellation.h"

namespace selvage::solid {

// The chord error in force for this yarn.
double chord_of(const yarn::Body& body, const CheckOptions& options);

// Never throws; a refusal of CGAL or of the tessellation is a defect of the yarn.
YarnCheck check_yarn(const yarn::Body& body, double chord);

}  // namespace selvage::solid
