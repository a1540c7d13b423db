// The pieces of a cut yarn's surface as faces that are not closed round. Internal to this folder.
#pragma once

#include <cstddef>
#include <vector>

#include "cad/model.h"
#include "cell/edge_curves.h"
#include "cell/faces.h"

namespace selvage::cell {

struct TubeFaces {
  std::vector<EdgeCurves> edges;
  // Of each body; the surface is the part that the face needs. Loops: the outer one first; counter-clockwise
  // in (u, v). Edges have their number in `edges`.
  std::vector<std::vector<cad::Face>> of_body;
  // The edges that each arc was divided into, in its direction, in the order of Division::edges; those of an
  // arc that is a border by itself begin anywhere.
  std::vector<std::vector<std::size_t>> of_arc;

  [[nodiscard]] cad::Edge edge(std::size_t number, bool backward) const;  // without its flat curve
};

// A piece that goes all round is divided along two lines of constant u, any other one along the surface's
// seam where it crosses that; with them, an end that lies inside the box is divided at its corners. Edges fit
// within `tolerance` (file units), of places nearer than ten of which one vertex is made; where yarns cross
// the box's edges they end in the corners' own numbers. Errors (geometry): a yarn closed along; a piece that
// such lines do not divide in two, with the yarn and the place.
Result<TubeFaces> tube_faces(std::span<const yarn::Body> bodies, const Box3& box, const Cut& cut,
                             const Division& division, double tolerance);

}  // namespace selvage::cell
