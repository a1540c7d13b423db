#include "nurbs/bezier_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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

// The shares of the inner control points in B(t).
Vec2 shares_at(double t) {
  const double s = 1.0 - t;
  return {3.0 * t * s * s, 3.0 * t * t * s};
}

LeastSquares equations(const std::vector<Vec2>& points, const std::vector<double>& parameters) {
  LeastSquares sums;
  const Vec2 end = points.back() - points.front();
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const double t = parameters[i];
    const Vec2 shares = shares_at(t);
    const Vec2 rest = points[i] - points.front() - t * t * t * end;
    sums.matrix += shares * shares.transpose();
    sums.right += shares * rest.transpose();
  }
  return sums;
}

// The degree-elevated parabola through three points at 0, t, 1.
Eigen::Matrix2d elevated_parabola(const std::vector<Vec2>& points, double t) {
  const Vec2 end = points[2] - points[0],
             peak = (points[1] - points[0] - t * t * end) / (2.0 * t * (1.0 - t));
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

// Steepest descent from `inner`, over all cubics or over parabolas alone, both of whose inner control points
// move alike; returns the number of steps.
int descend(const LeastSquares& sums, double extent, bool parabola, Eigen::Matrix2d& inner) {
  constexpr double share = 1e-13;  // see the header
  constexpr int most = 20'000;
  const double enough = share * extent * (sums.matrix(0, 0) + std::abs(sums.matrix(0, 1)));
  for (int step = 0; step < most; ++step) {
    Eigen::Matrix2d slope = sums.matrix * inner - sums.right;
    if (parabola) slope.rowwise() = slope.colwise().mean().eval();
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

TurningShape shape_of(bool left, bool right) {
  if (!left && !right) return TurningShape::straight;
  return left && right ? TurningShape::s : TurningShape::c;
}

// Steps in proportion to this power of the distances between the points: 0 uniform, 1 chord.
std::vector<double> parameters_by(const std::vector<Vec2>& points, double power) {
  std::vector<double> parameters = {0.0};
  for (std::size_t i = 1; i < points.size(); ++i)
    parameters.push_back(power == 0.0
                             ? static_cast<double>(i) / static_cast<double>(points.size() - 1)
                             : parameters.back() + std::pow((points[i] - points[i - 1]).norm(), power));
  if (power > 0.0)
    for (double& t : parameters) t /= parameters.back();
  return parameters;
}

Bezier solved_at(const std::vector<Vec2>& points, const std::vector<double>& parameters) {
  if (points.size() < 3) return assembled(points, thirds(points.back() - points.front()));
  if (points.size() == 3) return assembled(points, elevated_parabola(points, parameters[1]));
  const LeastSquares sums = equations(points, parameters);
  return assembled(points, Eigen::Matrix2d(sums.matrix.inverse() * sums.right));
}

// The squared distances between inner points and their places on the curve.
double sum_of_squares(const std::vector<Vec2>& points, const Bezier& curve,
                      const std::vector<double>& parameters) {
  double sum = 0.0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i)
    sum += (evaluate(curve, parameters[i]) - points[i]).squaredNorm();
  return sum;
}

// The least squares problem whose unknowns are the inner control points and the inner parameters.
class Nearest {
 public:
  Nearest(const std::vector<Vec2>& points, std::vector<double> start)
      : points_(points), parameters_(std::move(start)), curve_(solved_at(points, parameters_)) {
    sum_ = sum_of_squares(points_, curve_, parameters_);
  }

  // Until nothing changes.
  void improve() {
    constexpr int most_steps = 1000;
    constexpr double most_damping = 1e12;
    const double extent = bounds_of(points_).diagonal().norm();
    for (int step = 0; step < most_steps && damping_ < most_damping && sum_ > 0.0; ++step) {
      const double moved = attempt();
      if (moved >= 0.0 && moved <= least_move * extent) break;
    }
  }

  [[nodiscard]] bool is_in_order() const {
    return parameters_.front() == 0.0 && parameters_.back() == 1.0 && std::ranges::is_sorted(parameters_);
  }
  [[nodiscard]] double sum() const { return sum_; }
  [[nodiscard]] const std::vector<double>& parameters() const { return parameters_; }

 private:
  static constexpr double least_move = 1e-15;

  // One damped step of Gauss and Newton; how far it moved the control points, negative: not at all. The
  // parameters, each in one pair of equations alone, are eliminated: four unknowns are left.
  double attempt() {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    for_each_inner([&](std::size_t, const Row& row) {
      matrix += row.by_control.transpose() * row.by_control;
      right -= row.by_control.transpose() * row.rest;
    });
    matrix.diagonal() *= 1.0 + damping_;
    for_each_inner([&](std::size_t, const Row& row) {
      const Eigen::Vector4d mixed = row.by_control.transpose() * row.by_parameter;
      matrix -= mixed * mixed.transpose() / row.pivot;
      right += mixed * (row.by_parameter.dot(row.rest) / row.pivot);
    });
    const Eigen::Vector4d move = matrix.ldlt().solve(right);
    Bezier curve = curve_;
    curve[1] += move.head<2>();
    curve[2] += move.tail<2>();
    std::vector<double> parameters = parameters_;
    for_each_inner([&](std::size_t i, const Row& row) {
      parameters[i] -= row.by_parameter.dot(row.rest + row.by_control * move) / row.pivot;
    });
    const double sum = sum_of_squares(points_, curve, parameters);
    const bool better = sum < sum_;
    damping_ *= better ? 0.1 : 4.0;
    if (!better) return -1.0;
    curve_ = curve;
    parameters_ = std::move(parameters);
    sum_ = sum;
    return move.norm();
  }

  struct Row {
    Eigen::Matrix<double, 2, 4> by_control;
    Vec2 by_parameter, rest;
    double pivot = 0;
  };
  template <class Visit>
  void for_each_inner(const Visit& visit) const {
    for (std::size_t i = 1; i + 1 < points_.size(); ++i) {
      const double t = parameters_[i];
      const Vec2 shares = shares_at(t);
      Row row;
      row.by_control << shares[0], 0.0, shares[1], 0.0, 0.0, shares[0], 0.0, shares[1];
      row.by_parameter = derivative(curve_, t);
      row.rest = evaluate(curve_, t) - points_[i];
      row.pivot = row.by_parameter.squaredNorm() * (1.0 + damping_);
      if (row.pivot > 0.0) visit(i, row);
    }
  }

  const std::vector<Vec2>& points_;
  std::vector<double> parameters_;
  Bezier curve_;
  double sum_ = 0, damping_ = 1e-4;
};

std::vector<double> nearest_parameters(const std::vector<Vec2>& points) {
  constexpr double met = 1e-12;  // of the extent
  const double enough = met * bounds_of(points).diagonal().norm();
  std::vector<double> best = parameters_by(points, 1.0);
  double least = std::numeric_limits<double>::infinity();
  for (const double power : {1.0, 0.5, 0.0}) {
    Nearest nearest(points, parameters_by(points, power));
    nearest.improve();
    if (!nearest.is_in_order() || !(nearest.sum() < least)) continue;
    best = nearest.parameters();
    least = nearest.sum();
    if (least <= enough * enough) break;
  }
  return best;
}

std::vector<double> parameters_of(const std::vector<Vec2>& points, PointParameters how) {
  constexpr std::size_t met_anyway = 4;
  if (how == PointParameters::distance && points.size() > met_anyway) return nearest_parameters(points);
  return parameters_by(points, how == PointParameters::uniform ? 0.0 : 1.0);
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
  return shape_of(left, right);
}

TurningShape turning_shape(const Bezier& curve) {
  constexpr double least = 1e-3;
  const Turning turned = turning(curve);
  return shape_of(turned.left > least, turned.right > least);
}

BezierFit fit_bezier(const std::vector<Vec2>& points, PointParameters how) {
  BezierFit fit;
  fit.parameters = parameters_of(points, how);
  fit.solved = solved_at(points, fit.parameters);
  Eigen::Matrix2d inner = thirds(points.back() - points.front());
  if (points.size() > 2)
    fit.iterations = descend(equations(points, fit.parameters), bounds_of(points).diagonal().norm(),
                             points.size() == 3, inner);
  fit.descended = assembled(points, inner);
  return fit;
}

}  // namespace selvage::nurbs
