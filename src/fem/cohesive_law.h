// How cohesive interfaces open.
#pragma once

#include "core/diagnostics.h"
#include "fem/mesh.h"

namespace selvage::fem {

// Fills Mesh::laws and Interface::law: one a pair of materials. What both materials say of their interface
// holds, of each value the lower one; of what neither says:
// - no strength and no energy: nothing breaks.
// - stiffness, normal and shear: 10^4 E / t, E the larger Young's modulus across the two materials' fibres, t
//   the thickness of the thinnest yarn (four volumes over its interfaces' area), as A. Turon, C. G. Davila,
//   P. P. Camanho, J. Costa, An engineering solution for mesh size effects in the simulation of delamination
//   using cohesive zone models, Engineering Fracture Mechanics 74 (2007) 1665-1682, have it: of layers t the
//   interfaces then take a share of 10^-4 or less of the deformation. They want a factor of 50 or more.
//
// Before: Region::exact_volume and materials are there. Error (geometry), at the material: an energy that is
// less than what the interface has taken elastically at its strength.
Status choose_cohesive_laws(Mesh& mesh);

}  // namespace selvage::fem
