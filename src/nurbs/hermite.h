// The cubic B-spline that has given points and derivatives.
#pragma once

#include <vector>

#include "nurbs/spline.h"

namespace selvage::nurbs {

// Over `parameters` (increasing, at least two), one point and one derivative each: cubic between every two of
// them. Knots stand where the cubics of both sides differ alone, once where their second derivatives are
// equal, else twice (C1), as far as numbers of such points tell: to 1e-12 of the largest coordinate. What was
// sampled from a cubic B-spline, at its knots at least, is that B-spline again. Clamped.
Curve through_derivatives(const std::vector<double>& parameters, const std::vector<Vec3>& points,
                          const std::vector<Vec3>& derivatives);

}  // namespace selvage::nurbs
