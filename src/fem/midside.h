// From four nodes to ten.
#pragma once

#include <cstddef>

#include "fem/mesh.h"
#include "fem/surface_mesh.h"
#include "yarn/body.h"

namespace selvage::fem {

// Gives the corner-only elements of `mesh` (one region, file units; its first nodes are the surface's points)
// their six midside nodes, appended to the nodes, and sets order 2. Those on the boundary lie on the yarn's
// B-spline surface, or as far on the way there as every element's scaled Jacobian stays above 0.1 (or above
// 0.9 of its straight one where that is lower). Returns how many were held back.
std::size_t add_midside_nodes(Mesh& mesh, const SurfaceMesh& surface, const yarn::Body& body);

}  // namespace selvage::fem
