// Curves and surfaces that are given by a function, or by their distance from others, as cubic B-splines.
#pragma once

#include <functional>
#include <vector>

#include "nurbs/spline.h"

namespace selvage::nurbs {

// A shape and how far from the function it was found to be halfway between the places it goes through.
template <class Shape>
struct Fitted {
  Shape shape;
  double error = 0;
};

// Through at(t) at each of `breaks` (increasing, two at least) and at places between them, ever more of them
// until the error is `tolerance` at most or a span has 64; C2.
Fitted<Curve> fitted(const std::vector<double>& breaks, const std::function<Vec3(double)>& at,
                     double tolerance);
Fitted<Surface> fitted(const std::vector<double>& breaks_u, const std::vector<double>& breaks_v,
                       const std::function<Vec3(double, double)>& at, double tolerance);

// S + distance S_u x S_v / |S_u x S_v|. Where the normal vanishes (a pole), that of a place beside it is
// taken. An error that stays large is a surface with an edge in it: its offset is torn there.
Fitted<Surface> offset(const Surface& base, double distance, double tolerance);

// The unit normal S_u x S_v at one place, or beside it where that vanishes.
Vec3 unit_normal(const Surface& surface, double u, double v);

}  // namespace selvage::nurbs
