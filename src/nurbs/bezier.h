// Plane cubic Bezier curves over [0, 1]: the outlines of garment pieces.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/vec.h"
#include "nurbs/spline.h"

namespace selvage::nurbs {

using Bezier = std::array<Vec2, 4>;
using Box2 = Eigen::AlignedBox2d;

// A straight line as a cubic: inner control points on the thirds.
Bezier straight_bezier(const Vec2& from, const Vec2& to);

Vec2 evaluate(const Bezier& curve, double t);
Vec2 derivative(const Bezier& curve, double t);

// The smallest box that holds the curve itself (its extrema are the roots of two quadratics).
Box2 bounds(const Bezier& curve);

// One half of the integral of (p - origin) x dp along the curve; round a closed outline the sum is the area
// inside, positive where the outline runs counter-clockwise (Green). Exact to rounding: the integrand has
// degree 5, three Gauss nodes integrate it.
double swept_area(const Bezier& curve, const Vec2& origin);

// How far the tangent turns to the left and to the right between the curve's ends, radians, both at least 0.
// What lies between is exact: a cubic changes sides at the roots of a quadratic.
struct Turning {
  double left = 0, right = 0;
};
Turning turning(const Bezier& curve);

// How far the curve runs against the direction from B(from) to B(to) between these two, 0 where it never
// does.
double run_back(const Bezier& curve, double from, double to);

// The parameter of the curve's point nearest to `target`, to the last bits where the curve is regular.
double nearest_parameter(const Bezier& curve, const Vec2& target);

// A curve, seen from +z, as cubics one after the other, one's end the next one's start to the bit: the curve
// itself where it is a polynomial of degree 3 at most, else within `tolerance` of it, as samples tell.
std::vector<Bezier> cubics_of(const Curve& curve, double tolerance);

// Two places of an outline that meet although they should not, on curves a <= b (a == b: it crosses itself).
struct Crossing {
  std::size_t a = 0, b = 0;
  Vec2 at = Vec2::Zero();
};

// The first place where the closed outline crosses or touches itself, beyond neighbours' common ends.
// Precondition: each curve's last point is the next one's first, to the bit, the last one's the first one's.
// Curves are divided until boxes and tangent cones of their parts tell (the control polygon bounds the
// curve); what comes nearer than 1e-9 of the outline's size touches.
std::optional<Crossing> find_crossing(const std::vector<Bezier>& outline);

}  // namespace selvage::nurbs
