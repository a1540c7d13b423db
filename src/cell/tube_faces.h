// The pieces of a cut yarn's surface as faces that are not closed round. Internal to this folder.
#pragma once

#include <cstddef>
#include <vector>

#include "cell/cut.h"
#include "cell/edge_curves.h"

namespace selvage::cell {

// One use of an edge by a loop.
struct EdgeUse {
  std::size_t edge = 0;
  bool backward = false;
  double shift_u = 0;  // to be added to the edge's flat curve for this face
};
using EdgeLoop = std::vector<EdgeUse>;

struct TubeFace {
  std::size_t body = 0;
  // The part of the surface's domain that it needs.
  double low_u = 0, high_u = 0, low_v = 0, high_v = 0;
  std::vector<EdgeLoop> loops;  // the outer one first; counter-clockwise in (u, v)
};

struct TubeFaces {
  std::vector<EdgeCurves> edges;
  std::vector<TubeFace> faces;
  // The edges that each arc was divided into, in its direction, in the order of Division::edges; those of an
  // arc that is a border by itself begin anywhere.
  std::vector<std::vector<std::size_t>> of_arc;
};

// A piece that goes all round is divided along two lines of constant u, any other one along the surface's
// seam where it crosses that; with them, an end that lies inside the box is divided at its corners. Edges fit
// within `tolerance` (file units), of places nearer than ten of which one vertex is made. Errors (geometry):
// a yarn closed along; a piece that such lines do not divide in two, with the yarn and the place.
Result<TubeFaces> tube_faces(std::span<const yarn::Body> bodies, const Box3& box, const Cut& cut,
                             double tolerance);

}  // namespace selvage::cell
