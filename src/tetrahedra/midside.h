// From four nodes to ten.
#pragma once

#include "fem/mesh.h"
#include "surface_mesh/curved_edges.h"

namespace selvage::fem {

struct Block;

// Gives the corner-only elements of a block's mesh (mm, regions filled) their six midside nodes, appended to
// the nodes, and sets order 2. Edges of sides between regions, or outside, whose corners stand on one yarn's
// surface are curved: their middles lie on it, those of edges in a face of the box exactly in that face, and
// those of opposite faces where the cell is periodic are the same to the bit. They are taken back toward the
// chord where a scaled Jacobian would fall below 0.1 (or 0.9 of the straight one where that is lower). Away
// from the faces of the box those of a yarn stand off its surface by one share of their heights over the
// chord, mostly some hundredths and at most a quarter, so that the yarn has its volume; where elements would
// fold, or that is not enough, they stay on it.
MidsideNodes add_midside_nodes(Mesh& mesh, const Block& block);

}  // namespace selvage::fem
