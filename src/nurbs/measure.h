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

// What one face gives to the integrals over a body that it bounds, by its normal S_u x S_v.
struct Moments {
  double area = 0;
  Vec3 area_vector = Vec3::Zero();  // of a closed body's faces the sum is 0
  double volume = 0;                // volume_flux(surface, origin)
  Vec3 first =
      Vec3::Zero();  // of the volume: the sum over a body's faces is (centroid - origin) times its volume

  Moments& operator+=(const Moments& other);
  // Of the same face with its normal turned over.
  [[nodiscard]] Moments turned() const { return {area, -area_vector, -volume, -first}; }
};

// All but the area is exact for polynomial surfaces, to rounding. The area is exact to `area_error` or 1e-10
// of itself, whichever is more, by estimate: spans are halved until two rules agree so far, five times at
// most. One third and one quarter of the flux of (position - origin) and of its tensor square: divergence
// theorem.
Moments moments(const Surface& surface, const Vec3& origin, double area_error = 0);

}  // namespace selvage::nurbs
