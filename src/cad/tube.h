// Surfaces that are closed round, brought to the form of a yarn's body.
#pragma once

#include <optional>

#include "nurbs/spline.h"

namespace selvage::cad {

struct Tube {
  nurbs::Surface surface;  // u round, clamped, first column equal to the last to the bit; v along, clamped
  bool closed_along = false;
};

// Nothing for a surface that is closed in neither direction, or that has a pole at an end.
std::optional<Tube> as_tube(const nurbs::Surface& surface);

// A cap with a pole in its middle: closed round, its first row the border (turned round if need be), its last
// row one point. Nothing for another surface.
std::optional<nurbs::Surface> as_fan(const nurbs::Surface& surface);

// The surface with u and v exchanged.
nurbs::Surface transposed(const nurbs::Surface& surface);
// The surface with u (v) run backwards; knots become (first + last) - knot.
nurbs::Surface reversed_u(const nurbs::Surface& surface);
nurbs::Surface reversed_v(const nurbs::Surface& surface);
// The surface clamped in both directions; the same numbers where it is already.
nurbs::Surface clamped(const nurbs::Surface& surface);

// Largest extent of the control points' box.
double extent(const std::vector<Vec3>& points);

}  // namespace selvage::cad
