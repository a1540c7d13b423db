// Hexahedra of eight nodes, and the wedges that some of them are (mesh.h): how good they are, how large.
#pragma once

#include <array>

#include "core/vec.h"
#include "fem/quality.h"

namespace selvage::fem {

using EightNodes = std::array<Vec3, 8>;  // of a wedge 0 1 2 2, 4 5 6 6

// Angles between sides along each edge, at each corner. The scaled Jacobian is the least over the corners and
// the points of full integration of the determinant by the product of its columns' lengths (of a wedge times
// 2 / sqrt(3)): <= 0 where the element is turned inside out somewhere. P. M. Knupp, Achieving finite element
// mesh quality via optimization of the Jacobian matrix norm, Int. J. Numer. Meth. Engng 48 (2000).
ElementShape shape_of_hexahedron(const EightNodes& nodes, bool is_wedge);

// Exact: the determinant is quadratic in each direction.
double volume_of_hexahedron(const EightNodes& nodes);

}  // namespace selvage::fem
