// Lengths, areas and volumes of splines by Gauss quadrature span by span: exact (to rounding) for polynomial
// surfaces.
#pragma once

#include "nurbs/spline.h"

namespace selvage::nurbs {

// Arc length between two parameters, to about 1e-12 of the length (adaptive Gauss-Legendre).
double arc_length(const Curve& curve, double t0, double t1);
double arc_length(const Curve& curve);

// One third of the flux of (position - origin) through the surface, by its normal S_u x S_v: the sum over the
// faces of a closed body is its volume (divergence theorem). Exact for polynomial surfaces.
double volume_flux(const Surface& surface, const Vec3& origin);

}  // namespace selvage::nurbs
