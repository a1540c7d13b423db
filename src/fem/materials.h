// What the yarns are made of, for a solver: every yarn has a material with elastic constants in the end.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "fabric/model.h"
#include "yarn/body.h"

namespace selvage::fem {

// The stand-in for a yarn without elastic constants: isotropic, E = 10 000 MPa, nu = 0.3, 1.5 g/cm3. It lets
// a deck run; it is nobody's fibre, and a warning says so.
fabric::Material generic_material();

struct MaterialChoice {
  std::vector<fabric::Material> materials;  // those in use, in order of first use
  std::vector<std::string> of_body;         // the name of each body's
};

// Materials of the bodies by Body::material. Warnings: a yarn without material, a material without elastic
// constants.
MaterialChoice choose_materials(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                                Diagnostics& diagnostics);

}  // namespace selvage::fem
