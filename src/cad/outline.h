// Faces that are parts of their surfaces: their outlines, and how far two such faces are apart.
#pragma once

#include <optional>
#include <vector>

#include "cad/distance.h"
#include "cad/model.h"

namespace selvage::cad {

// The curves round a face in space, without seams (edges that it has twice) and poles; those of the whole
// surface where it has no loops. A surface closed in both directions has none.
std::vector<nurbs::Curve> outline(const Face& face);

// The larger of the distances of each outline from the other; infinite where only one of the faces has one.
Reach outline_distance(const Face& a, const Face& b, double enough);

// The box of the face's loops in its surface's parameters, or the whole domain.
Range used_range(const Face& face);

// What a face takes up, however its parameters run: by points of its outline and a few inside.
struct Place {
  Box3 box;
  std::optional<Vec3> middle;  // of the points inside; none where the loops are not given in the parameters
};
Place place_of(const Face& face);

// The control points lie in one plane (to 1e-9 of their extent): the face is its outline's inside.
bool is_flat(const nurbs::Surface& surface);

// How far a face is from the other one's surface: from a whole surface to a trimmed one, of two trimmed ones
// both ways over their used_range. Together with the outlines' distance this tells how far the faces are
// apart.
Reach trimmed_distance(const Face& a, const Face& b, double enough);

// The one that says more: that was found to be farther than `enough`, or else the less certain one.
const Reach& worse(const Reach& a, const Reach& b, double enough);

}  // namespace selvage::cad
