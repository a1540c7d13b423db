// Lengths, areas and volumes of splines by Gauss quadrature span by span: exact (to rounding) for polynomial
// surfaces.
#pragma once

#include <functional>

#include "nurbs/spline.h"

namespace selvage::nurbs {

// The integral of a function that is not negative, to about 1e-13 of it: Gauss-Legendre with eight nodes, and
// halves of halves until they agree with the whole. `rounding` is the absolute error of one piece that is
// enough once there are many; `f` is called at most 70 000 times, whatever it does.
double adaptive_integral(const std::function<double(double)>& f, double t0, double t1, double rounding);

// Arc length between two parameters, to about 1e-12 of the length (adaptive Gauss-Legendre).
double arc_length(const Curve& curve, double t0, double t1);
double arc_length(const Curve& curve);

// One third of the flux of (position - origin) through the surface, by its normal S_u x S_v: the sum over the
// faces of a closed body is its volume (divergence theorem). Exact for polynomial surfaces.
double volume_flux(const Surface& surface, const Vec3& origin);

}  // namespace selvage::nurbs
