// A cubic B-spline near measured points, with as few knots as their error asks for: least squares, knots
// where points are too far from the curve, the parameters of the points being those of the curve's nearest
// places (P. Dierckx, Curve and Surface Fitting with Splines, Oxford 1993, 4 and 5.2, on knots; J. Hoschek,
// Intrinsic parametrization for approximation, CAGD 5 (1988), on parameters).
#pragma once

#include <optional>
#include <vector>

#include "nurbs/spline.h"

namespace selvage::nurbs {

struct Smoothed {
  Curve curve;                     // cubic over [0, 1], C2; closed: first and last point equal to the bit
  std::vector<double> parameters;  // one a point: where the curve is nearest to it; noise changes their order
  double farthest = 0;             // the largest distance of a point from the curve there
};

// No point is farther than `error` (> 0) from the curve. At least two points (closed: five, the first follows
// the last), in the order of the line, neighbours differ. None: so few points for each span do not tell a
// curve within `error`; an interpolation does.
std::optional<Smoothed> smooth(const std::vector<Vec3>& points, double error, bool closed);

}  // namespace selvage::nurbs
