// A cubic Bezier through the fixed points of a garment curve, without hand-placed control points: methods.md,
// 5, after Gu and Shi, "Research on Automatic Method of Curves Drawing in Garment CAD Pattern System"
// (../shared/references 004): ends kept, parameters i / n (eq. 7), inner control points by solving the
// equations and by gradient descent (eq. 2-4).
#pragma once

#include <vector>

#include "nurbs/bezier.h"

namespace selvage::nurbs {

enum class TurningShape { straight, c, s };

// By the sign of the turning of the polygon through the points: all turns one way (c), both ways (s), none.
// A turn whose sine is under 1e-9 is none.
TurningShape turning_shape(const std::vector<Vec2>& points);

struct BezierFit {
  Bezier solved;     // by the normal equations of the least squares problem
  Bezier descended;  // by steepest descent on the same sum of squared distances
  int iterations = 0;
};

// n + 1 >= 2 finite points, not all of them the same. The sum over the inner points of |B(i / n) - Q_i|^2 is
// made least. Its normal matrix is 2 x 2 and equal in x and y; with two inner points or more it is regular
// (largest over smallest eigenvalue: 9 for two, 7 for very many), and descent with the exact step of each
// line search, begun on the thirds of the chord, gains a digit in about ten steps. It stops where the
// gradient bounds the error of the control points by 1e-12 of the points' extent.
// One inner point leaves a family of solutions: both methods take the degree-elevated parabola, which is the
// nearest one to the thirds of the chord. No inner point: the straight line.
BezierFit fit_bezier(const std::vector<Vec2>& points);

}  // namespace selvage::nurbs
