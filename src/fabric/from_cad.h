// A CAD file as a fabric: what is a yarn or a garment piece by its geometry becomes one again, the rest is
// kept as it is.
#pragma once

#include "cad/model.h"
#include "core/diagnostics.h"
#include "fabric/model.h"

namespace selvage::fabric {

// Yarns keep every control point, knot and weight, and their end faces. Nothing is lost: what is not
// recognised is in Fabric::parts and Fabric::curves. Warnings go to `diagnostics`.
Fabric fabric_of(cad::Model model, Diagnostics& diagnostics);

}  // namespace selvage::fabric
