// Areas and volumes of faces, trimmed or not, and of what they enclose.
#pragma once

#include <optional>

#include "cad/model.h"

namespace selvage::cad {

// Integrals over a face, by the normal S_u x S_v of its surface.
struct FaceIntegrals {
  double area = 0;
  Vec3 area_vector = Vec3::Zero();  // of a closed body's faces the sum is 0
  double volume = 0;                // a third of the flux of (position - origin)
};

// Gauss's rule span by span, of a trimmed face along its boundary by Green's theorem: the integral over a
// face in parameters is one round its boundary of what is integrated along lines of one parameter up to
// there. Edges in space only are followed by their feet on the surface. Good for some 1e-8 where edges lie on
// the surface. Nothing where the boundary does not tell which side of it is the face (a cap round a pole,
// say).
std::optional<FaceIntegrals> integrals_of(const Face& face, const Vec3& origin);

struct PartMeasures {
  std::optional<double> area;  // of all faces
  std::optional<double>
      volume;  // of a solid whose faces' area vectors add up to nothing, to 1e-3 of its area
};
// Of a face that is not understood the area is what another program's kernel measured, if one did.
PartMeasures measures_of(const Part& part);

// How far edges are from where their faces need them, in the model's unit: the largest distance from an
// edge's end to the start of the one behind it in the loop, and from an edge's curve to its curve on the
// surface (where it has none: to the surface), by five points of each.
double looseness_of(const std::vector<Part>& parts);

}  // namespace selvage::cad
