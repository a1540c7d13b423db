// Faces on spheres, whose poles are nothing but a matter of parameters.
#pragma once

#include <optional>

#include "cad/measure.h"

namespace selvage::cad {

struct Sphere {
  Vec3 center = Vec3::Zero();
  double radius = 0;
};

// The sphere that the whole surface lies on, to 1e-7 of its radius at 49 of its points; none: there is none.
std::optional<Sphere> sphere_of(const nurbs::Surface& surface);

// integrals_of() of a face on a sphere, along its boundary in space: what lies to the left of it has, on the
// unit sphere, the area that a vector potential with one singular point has round it (mod 4 pi), and twice
// the area vector of the cone over it. The face has loops, all to the left of Su x Sv. Nothing where an edge
// has no curve at all but is no pole, or where the boundary is everywhere.
std::optional<FaceIntegrals> integrals_on(const Sphere& sphere, const Face& face, const Vec3& origin);

}  // namespace selvage::cad
