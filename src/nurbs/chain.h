// Curves brought onto common degrees and knots, and put one after the other.
#pragma once

#include <vector>

#include "nurbs/spline.h"

namespace selvage::nurbs {

// The same points at the same parameters with a degree that is no lower, as Bezier pieces between `breaks`
// (increasing, all of the curve's breakpoints among them). Linear in the number of pieces.
Curve in_pieces(const Curve& curve, const std::vector<double>& breaks, int degree);

// The curves one after the other, each over a range as long as its own, the first over its own; inner knots
// of degree-fold multiplicity where two meet. The highest degree of any; rational where one is. What follows
// begins at the end of what was before: the caller sees to it that they meet. At least one curve.
Curve chained(const std::vector<Curve>& curves);

// The largest distance between an end and the next start.
double largest_gap(const std::vector<Curve>& curves);

// Both over [0, 1], with the degree and the knots of both: what a surface between them needs.
void make_compatible(Curve& a, Curve& b);

// The same points, `from` to `to` as its range (knots changed affinely; those at the ends to the bit).
Curve with_range(const Curve& curve, double from, double to);

// u and v exchanged: S_u x S_v turns round.
Surface transposed(const Surface& surface);

}  // namespace selvage::nurbs
