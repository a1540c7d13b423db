// What keeps a unit cell from moving as a whole in its load cases.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/groups.h"
#include "fem/mesh.h"

namespace selvage::fem {

// A node whose displacements (or potential) are to be zero in every load case, or only the one along x, y or
// z (0, 1, 2). No force acts there: what moves as a whole is all that the conditions of the cell leave free.
struct NodeSupport {
  std::size_t node = 0;
  std::optional<int> direction;
};

// Nodes that elements, interfaces and conditions connect are one group.
Groups connected_nodes(const Mesh& mesh);

// Of a complete cell (cell_problem/complete_cell.h): of each part that nothing connects with another one a
// node that depends on none (of the part at the cell's corner 0 the node there), and of a beam a second one
// against turning about its axis. Empty without a periodic axis, where the faces follow the drivers.
std::vector<NodeSupport> supports(const Mesh& mesh);

}  // namespace selvage::fem
