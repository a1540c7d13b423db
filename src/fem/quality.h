// How good elements are; see fem::Quality for what the figures mean.
#pragma once

#include <array>
#include <vector>

#include "core/vec.h"
#include "fem/mesh.h"

namespace selvage::fem {

struct ElementShape {
  double min_dihedral = 0, max_dihedral = 0;  // degrees
  double aspect = 0;
  double scaled_jacobian = 0;
};

// Of the tetrahedron with straight edges.
ElementShape shape_of(const std::array<Vec3, 4>& corners);

// Of a ten-node tetrahedron (order of nodes: mesh.h): the smallest Jacobian determinant at the nodes, the
// middles of the faces and the middle, as a share of the straight tetrahedron's. 1: straight; <= 0: folded.
double least_jacobian_share(const std::array<Vec3, 10>& nodes);

// Volume of a ten-node tetrahedron (exact: its Jacobian is a cubic, integrated by the five-point rule of
// degree 3).
double quadratic_volume(const std::array<Vec3, 10>& nodes);

// Of one element of a mesh, or of a wedge of its layers, numbered behind them: as above, the scaled Jacobian
// of a ten-node element times its least share; of hexahedra and wedges as in hexahedron.h.
ElementShape shape_of(const Mesh& mesh, std::size_t element);

// The mean of an element's corners.
Vec3 middle_of(const Mesh& mesh, std::size_t element);

// Of one element.
double volume_of(const Mesh& mesh, std::size_t element);

// Degrees: a hundredth of the mesh's elements has a smallest dihedral angle below it. 0: no elements.
double first_percentile_angle(const Mesh& mesh);

// Fills Quality and volume of every region, the mesh's own, and its worst elements.
void measure(Mesh& mesh);

}  // namespace selvage::fem
