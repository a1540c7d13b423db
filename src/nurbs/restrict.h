// A part of a B-spline curve or surface, of any knots: clamped or not.
#pragma once

#include "nurbs/spline.h"

namespace selvage::nurbs {

// The part between two parameters, clamped there: the same points at the same parameters, with the inner
// knots that it had. Preconditions: first parameter <= t0 < t1 <= last parameter; inner knots have at most
// the multiplicity `degree`. Control points are values of the polar form (Ramshaw 1989): de Boor's scheme
// with another argument in every step.
Curve restricted(const Curve& curve, double t0, double t1);
Surface restricted(const Surface& surface, double u0, double u1, double v0, double v1);

// The same surface with these knots inserted along v (increasing, inside the domain; multiplicities
// afterwards at most the degree). Control points whose knots do not change keep their values up to rounding.
Surface refined(const Surface& surface, const std::vector<double>& new_v);

}  // namespace selvage::nurbs
