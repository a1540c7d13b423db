// The conditions on the nodes of a cell's faces and the load cases; see cell_problem/complete_cell.h for what
// they say.
#pragma once

#include <vector>

#include "core/diagnostics.h"
#include "fem/mesh.h"

namespace selvage::fem {

// Fills drivers, equations and load cases of a mesh whose sets are there. `lowest`: of each node the one that
// it depends on, itself where it is free (or the cell has no periodic axis).
Status add_conditions(Mesh& mesh, const std::vector<std::size_t>& lowest);

}  // namespace selvage::fem
