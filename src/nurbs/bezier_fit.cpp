#include "nurbs/bezier_fit.h"

#include <cmath>

#include "core/bounds.h"
#include "core/plane.h"

namespace selvage::nurbs {

namespace {

// |A X - R|^2 with the rows of X the inner control points: M = A'A, K = A'R. Positions are relative to the
// first point.
struct LeastSquares {
  Eigen::Matrix2d matrix = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d right = Eigen::Matrix2d::Zero();
};

LeastSquares equations(const std::vector<Vec2>& points) {
  LeastSquares sums;
  const std::size_t n = points.size() - 1;
  const Vec2 end = points.back() - points.front();
  for (std::size_t i = 1; i < n; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(n), s = 1.0 - t;
    const Vec2 shares(3.0 * t * s * s, 3.0 * t * t * s);
    const Vec2 rest = points[i] - points.front() - t * t * t * end;
    sums.matrix += shares * shares.transpose();
    sums.right += shares * rest.transpose();
  }
  return sums;
}

// The degree-elevated parabola through three points at 0, 1/2, 1.
Eigen::Matrix2d elevated_parabola(const std::vector<Vec2>& points) {
  const Vec2 end = points[2] - points[0], peak = 2.0 * (points[1] - points[0]) - 0.5 * end;
  Eigen::Matrix2d inner;
  inner.row(0) = 2.0 / 3.0 * peak;
  inner.row(1) = end + 2.0 / 3.0 * (peak - end);
  return inner;
}

Eigen::Matrix2d thirds(const Vec2& end) {
  Eigen::Matrix2d inner;
  inner.row(0) = end / 3.0;
  inner.row(1) = 2.0 / 3.0 * end;
  return inner;
}

// Steepest descent from `inner`; returns the number of steps.
int descend(const LeastSquares& sums, double extent, Eigen::Matrix2d& inner) {
  constexpr double share = 1e-13;  // the error is at most nine times this: see the header
  constexpr int most = 1000;
  const double enough = share * extent * (sums.matrix(0, 0) + std::abs(sums.matrix(0, 1)));
  for (int step = 0; step < most; ++step) {
    const Eigen::Matrix2d slope = sums.matrix * inner - sums.right;
    const double square = slope.squaredNorm();
    const double curvature = slope.cwiseProduct(sums.matrix * slope).sum();
    if (std::sqrt(square) <= enough || !(curvature > 0.0)) return step;
    inner -= square / curvature * slope;
  }
  return most;
}

Bezier assembled(const std::vector<Vec2>& points, const Eigen::Matrix2d& inner) {
  const Vec2& origin = points.front();
  return {origin, origin + inner.row(0).transpose(), origin + inner.row(1).transpose(), points.back()};
}

}  // namespace

TurningShape turning_shape(const std::vector<Vec2>& points) {
  constexpr double straight = 1e-9;
  bool left = false, right = false;
  for (std::size_t i = 2; i < points.size(); ++i) {
    const Vec2 in = (points[i - 1] - points[i - 2]).normalized(),
               out = (points[i] - points[i - 1]).normalized();
    const double sine = cross(in, out);
    left = left || sine > straight;
    right = right || sine < -straight;
  }
  if (!left && !right) return TurningShape::straight;
  return left && right ? TurningShape::s : TurningShape::c;
}

BezierFit fit_bezier(const std::vector<Vec2>& points) {
  BezierFit fit;
  const Eigen::Matrix2d start = thirds(points.back() - points.front());
  if (points.size() < 3) {
    fit.solved = fit.descended = assembled(points, start);
    return fit;
  }
  const LeastSquares sums = equations(points);
  fit.solved = assembled(points, points.size() == 3 ? elevated_parabola(points)
                                                    : Eigen::Matrix2d(sums.matrix.inverse() * sums.right));
  Eigen::Matrix2d inner = start;
  fit.iterations = descend(sums, bounds_of(points).diagonal().norm(), inner);
  fit.descended = assembled(points, inner);
  return fit;
}

}  // namespace selvage::nurbs
