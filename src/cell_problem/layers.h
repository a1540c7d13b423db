// Layers of wedges along the walls of a pore space: the walls' nodes of its tetrahedra move inwards, and
// wedges fill what they leave, as the extrusion of boundary layers from a finished mesh: R. V. Garimella and
// M. S. Shephard, Boundary layer mesh generation for viscous flow simulations, Int. J. Numer. Meth. Engng 49
// (2000).
#pragma once

#include "core/diagnostics.h"
#include "fem/mesh.h"

namespace selvage::fem {

struct LayerOptions {
  int count = 0;
  double thickness = 0;  // of all together, mm; 0: two fifths of the edges that a wall has there
};

// Each layer is 1.2 times as thick as the one on its wall's side. Where the space is narrow, they are
// thinner: no tetrahedron loses more than two thirds of its volume or half of its smallest dihedral angle,
// and along an edge of a wall the thickness grows by no more than half. What was opposite over periodic faces
// stays so. Fills Mesh::layers; walls become sides of wedges, faces of the cell get their quadrilaterals,
// behind their triangles and in the same order on both of a pair; sets of nodes (UnitCell) get theirs.
//
// Precondition: the patches are complete, of tetrahedra of order 1; count >= 1. Error (geometry): a wall runs
// along an edge or through a corner of the cell, where its nodes have no way to go.
Status add_layers(Mesh& mesh, const LayerOptions& options);

}  // namespace selvage::fem
