// How long edges are in a unit cell, and how many tetrahedra that makes.
#pragma once

#include <span>

#include "core/parallelepiped.h"
#include "surface_mesh/size_field.h"
#include "yarn/body.h"

namespace selvage::fem {

// What the mesh of a cell keeps to: `sizes` are the largest edges on each body, `coarsest` is how long they
// may get away from them (at least the largest of these), `growth` how much per length, `extent` the smallest
// section extent of the bodies in the box; file units.
SizeRules cell_size_rules(std::span<const yarn::Body> bodies, std::span<const double> sizes, double coarsest,
                          double growth, double extent);

// Of the smallest section extent: no edge is shorter for a gap's sake, no two yarns may be nearer.
inline constexpr double least_edge_share = 0.01;

// About how many tetrahedra mesh_cell() makes of these sizes: the density of the size field, summed over
// places all over the box. Its effort is bounded, however small the sizes are. `matrix`: with it; else the
// yarns alone. The same for any number of threads.
double estimate_tetrahedra(std::span<const yarn::Body> bodies, const Parallelepiped& cell,
                           std::span<const double> sizes, double coarsest, double growth, bool matrix,
                           int threads);

}  // namespace selvage::fem
