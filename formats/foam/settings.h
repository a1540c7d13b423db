// What OpenFOAM wants of a case beside its mesh.
#pragma once

#include <string_view>

namespace selvage::formats::foam {

// The contents of system/controlDict, system/fvSchemes and system/fvSolution, without their heads: a steady
// laminar flow by simpleFoam, to begin with.
extern const std::string_view control, schemes, solution;

}  // namespace selvage::formats::foam
