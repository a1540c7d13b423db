// Regions of a cell that share no nodes where they meet: each gets nodes of its own.
#pragma once

#include <cstddef>
#include <vector>

#include "fem/mesh.h"

namespace selvage::fem {

// Doubles the nodes at which regions of tetrahedra meet, and fills Mesh::interfaces. Of several regions that
// meet at a place each has one node there; the first one keeps the number, the others' nodes stand behind all
// that there were, by the old number and then by the region.
//
// Before: the sets of the cell are there, their sides paired; `lowest`: of each node the one that it depends
// on. After: the same of all nodes. A node on a high side depends on that of the same body of material on the
// low side, as the paired sides of the faces say: a yarn that goes on over a face as another yarn is one with
// it. A region that reaches a face with no side (a tip that touches it) depends on nothing there. Where a
// region is not at all places that are opposite each other (its surface runs through an edge of the cell),
// its nodes there are in no set. Where bonding (cell_problem/bond.h) gave what lies before one face to a yarn
// and what lies behind the opposite one to the matrix, both are tied at the nodes between.
void double_nodes(Mesh& mesh, std::vector<std::size_t>& lowest);

}  // namespace selvage::fem
