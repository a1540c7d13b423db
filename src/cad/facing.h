// Do the faces of a solid all look outwards, or all inwards?
#pragma once

#include <cstddef>
#include <vector>

#include "cad/model.h"

namespace selvage::cad {

// The faces of a part (by number, increasing) that look to the other side than the faces next to them, where
// both share an edge: of each set of faces that hang together, the fewer ones. Two faces that look to one
// side go along their common edge in opposite directions, each with itself on its left seen from outside
// (Euler's and Moebius' rule). Edges up to `tolerance` apart (model units) are one; those of one face, of
// more than two, and those beside which it cannot be told on which side the face lies, say nothing.
std::vector<std::size_t> turned_faces(const Part& part, double tolerance);

}  // namespace selvage::cad
