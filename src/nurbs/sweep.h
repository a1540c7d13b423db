// Surfaces made of curves, exactly.
#pragma once

#include "nurbs/spline.h"

namespace selvage::nurbs {

// Straight lines between points of equal parameters, both over [0, 1] then: u along the curves, v in [0, 1]
// from a to b. Where both are rational with unequal weights the lines are the same, but v is not linear on
// them.
Surface ruled(const Curve& a, const Curve& b);

// The same where the second curve has the knots and weights of the first: by its control points.
Surface ruled(const Curve& first, const std::vector<Vec3>& second);

// origin + u x + v y over a rectangle of parameters.
Surface flat(const Vec3& origin, const Vec3& x, const Vec3& y, const Vec2& low, const Vec2& high);

// u along the curve, v in [0, 1] along `shift`.
Surface extruded(const Curve& directrix, const Vec3& shift);

// The curve turned about the axis through `foot` along `direction` (any length but zero), counter-clockwise
// seen against it, by angles `from` to `to` (radians, at most a whole turn): u along the curve, v the angle
// as in elliptic_arc (nurbs/conic.h). What is nearer to the axis than 1e-13 of the distances is on it; a
// whole turn is closed to the bit.
Surface revolved(const Curve& generatrix, const Vec3& foot, const Vec3& direction, double from, double to);

}  // namespace selvage::nurbs
