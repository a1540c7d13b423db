// Boundary triangles with their midside nodes.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "fem/mesh.h"

namespace selvage::fem {

// The two corners of the edge on which each midside node 4..9 of a tetrahedron stands.
inline constexpr std::array<std::array<std::size_t, 2>, 6> edge_ends = {
    {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

using SixNodes = std::array<std::size_t, 6>;  // corners, then the midpoints of the edges 01 12 20

// `faces` (boundary triangles of the region, or of any of its elements) with their midside nodes; with order
// 1 these entries are 0.
std::vector<SixNodes> six_node_faces(const Mesh& mesh, const Region& region,
                                     const std::vector<ElementSide>& faces);

}  // namespace selvage::fem
