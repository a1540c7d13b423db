// A cubic Bezier through the fixed points of a garment curve, without hand-placed control points: methods.md,
// 5, after Gu and Shi, "Research on Automatic Method of Curves Drawing in Garment CAD Pattern System"
// (../shared/references 004): ends kept, parameters given (eq. 6), evenly spaced (eq. 7) or those of the
// curve's nearest points, inner control points by solving the equations and by gradient descent (eq. 2-4).
#pragma once

#include <vector>

#include "nurbs/bezier.h"

namespace selvage::nurbs {

enum class TurningShape { straight, c, s };

// By the sign of the turning of the polygon through the points: all turns one way (c), both ways (s), none.
// A turn whose sine is under 1e-9 is none.
TurningShape turning_shape(const std::vector<Vec2>& points);
// By the turning of the curve itself; less than a thousandth of a radian, which nobody cuts, is none.
TurningShape turning_shape(const Bezier& curve);

// Where on the curve the n + 1 points are: at i / n; at their shares of the polygon's length; or where the
// curve passes nearest to them.
enum class PointParameters { uniform, chord, distance };

struct BezierFit {
  Bezier solved;                   // by the normal equations of the least squares problem
  Bezier descended;                // by steepest descent on the same sum of squared distances
  std::vector<double> parameters;  // t_i of the points: 0 = t_0 <= t_1 ... <= t_n = 1
  int iterations = 0;              // of the descent
};

// n + 1 >= 2 finite points, not all of them the same. The sum over the inner points of |B(t_i) - Q_i|^2 is
// made least. Its normal matrix is 2 x 2 and equal in x and y; with two inner points or more it is regular
// (at t_i = i / n its largest over its smallest eigenvalue is 9 for two, 7 for very many; parameters that
// crowd make it larger), and descent with the exact step of each line search, begun on the thirds of the
// chord, gains a digit in about as many steps. It stops where the gradient bounds the error of the control
// points by 1e-13 of the points' extent times that ratio, or after 20,000 steps.
// One inner point leaves a family of solutions: both methods take the degree-elevated parabola through the
// three. No inner point: the straight line.
//
// `distance`: the parameters are unknowns, too. Levenberg's and Marquardt's steps on all of them, from those
// by chord, until nothing changes: the sum is least among curves near that one, and the error at each inner
// point is its distance from the curve (Hoschek 1988, doi:10.1016/0167-8396(88)90026-1, has parameters
// corrected like this). Where that does not meet the points, centripetal and uniform beginnings are tried,
// too, and the best of those is taken that have the points in their order. Two inner points or fewer are met
// by the first curve; three are met by many, of which this one is near to that by chord.
BezierFit fit_bezier(const std::vector<Vec2>& points, PointParameters how = PointParameters::uniform);

}  // namespace selvage::nurbs
