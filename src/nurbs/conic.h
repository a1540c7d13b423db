// Arcs of conics as exact rational B-splines of degree 2 (Piegl and Tiller, The NURBS Book, ch. 7).
#pragma once

#include <array>
#include <optional>

#include "nurbs/spline.h"

namespace selvage::nurbs {

// center + cos(a) x + sin(a) y for a from `from` to `to` (radians, from < to <= from + 2 pi): a circle where
// x and y are orthogonal and equally long, else an ellipse. The knots are the angles, of which every 90
// degrees or less one stands, so that the curve is at a knot's angle exactly and between them within 0.3
// degrees of its parameter's. A whole turn (to 1e-9) is closed to the bit. Weights 1 at the knots.
Curve elliptic_arc(const Vec3& center, const Vec3& x, const Vec3& y, double from, double to);

// The angles at which an arc has its knots.
std::vector<double> arc_breaks(double from, double to);
// The parameter at which such an arc (knots: its breaks) is at `angle`.
double parameter_at_angle(const std::vector<double>& breaks, double angle);

// The same with the angle as its parameter, to 2e-11 of the radius: a polynomial of degree 5, pieces of at
// most pi / 32 with the arc's own first two derivatives at their ends.
Curve arc_by_angle(const Vec3& center, const Vec3& x, const Vec3& y, double from, double to);

// center + cosh(a) x + sinh(a) y, one branch of a hyperbola; from < to or the other way round. Knots 0 and 1.
Curve hyperbolic_arc(const Vec3& center, const Vec3& x, const Vec3& y, double from, double to);

// The parabola that leaves `from` toward `tip` and comes to `to` from there. Knots 0 and 1.
Curve parabolic_arc(const Vec3& from, const Vec3& tip, const Vec3& to);

// The plane curve A x^2 + B xy + C y^2 + D x + E y + F = 0, z = given, from one of its points to another;
// ellipses counter-clockwise, equal points mean all of it. Ends are the points given. Nothing, and a word
// why, where the coefficients are of no real conic, a point is off it by more than 1e-4 of the coordinates'
// size, or the points are on two branches of a hyperbola.
enum class ConicKind { unknown, ellipse, hyperbola, parabola };
struct ConicArc {
  std::optional<Curve> curve;
  const char* fault = "";
};
ConicArc conic_arc(const std::array<double, 6>& coefficients, double z, const Vec2& from, const Vec2& to,
                   ConicKind kind = ConicKind::unknown);

}  // namespace selvage::nurbs
