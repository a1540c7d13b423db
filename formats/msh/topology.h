// A mesh of a unit cell taken apart into what Gmsh calls entities: volumes are its regions, surfaces lie
// between two of them or between one and a face of the cell, curves and points where surfaces meet.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "fem/mesh.h"
#include "fem/sides.h"

namespace selvage::formats::msh {

struct Surface {
  std::size_t region = 0;                         // its sides are seen from out of this one
  std::size_t behind = fem::OuterSide::outside;   // the region beyond
  std::size_t facing = fem::OuterSide::outside;   // the one beyond that shares no nodes (fem::Mesh::joining)
  int face = -1;                                  // 0..5, A..F: of the cell; -1: inside
  std::size_t patch = 0;                          // of a pore space: index into fem::Mesh::patches
  std::vector<std::array<std::size_t, 4>> sides;  // corner nodes as in fem::OuterSide
  std::vector<std::size_t> curves;                // around it, indices
};

struct Curve {
  std::vector<std::array<std::size_t, 2>> edges;  // corner nodes, from `first` to `last`
  std::size_t first = 0, last = 0;                // indices of points, the same of a closed curve
};

struct Topology {
  std::vector<std::size_t> points;  // nodes
  std::vector<Curve> curves;
  std::vector<Surface> surfaces;
};

Topology topology_of(const fem::Mesh& mesh);

// An entity on the high side of a periodic axis (or of several) and the one that it repeats.
struct Copy {
  int dimension = 0;  // 0 points, 1 curves, 2 surfaces
  std::size_t entity = 0, original = 0;
  std::array<bool, 3> along = {};  // which edges of the cell lead here from the original
};

// `opposite`: of fem::opposite_nodes(). By dimension, then by entity. What has no complete copy on the other
// side is left out.
std::vector<Copy> copies_in(const Topology& topology,
                            const std::array<std::vector<std::size_t>, 3>& opposite);

}  // namespace selvage::formats::msh
