#include "nurbs/interpolate.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "core/wrapped.h"
#include "nurbs/basis.h"

namespace selvage::nurbs {

namespace {

// Solves the tridiagonal system low, diagonal, high for every column of `right`, in place (Thomas). B-spline
// collocation matrices are totally positive, so no pivoting is needed (de Boor 1978).
void solve_tridiagonal(const std::vector<double>& low, std::vector<double> diagonal,
                       const std::vector<double>& high, Eigen::MatrixXd& right) {
  const Eigen::Index n = right.rows();
  for (Eigen::Index i = 1; i < n; ++i) {
    const double factor = low[at(i)] / diagonal[at(i - 1)];
    diagonal[at(i)] -= factor * high[at(i - 1)];
    right.row(i) -= factor * right.row(i - 1);
  }
  right.row(n - 1) /= diagonal[at(n - 1)];
  for (Eigen::Index i = n - 2; i >= 0; --i)
    right.row(i) = (right.row(i) - high[at(i)] * right.row(i + 1)) / diagonal[at(i)];
}

Eigen::MatrixXd as_matrix(const std::vector<Vec3>& points) {
  Eigen::MatrixXd data(static_cast<Eigen::Index>(points.size()), 3);
  for (Eigen::Index i = 0; i < data.rows(); ++i) data.row(i) = points[at(i)].transpose();
  return data;
}

Curve as_curve(const std::vector<double>& knots, const Eigen::MatrixXd& control) {
  Curve curve;
  curve.degree = 3;
  curve.knots = knots;
  for (Eigen::Index i = 0; i < control.rows(); ++i) curve.points.emplace_back(control.row(i).transpose());
  return curve;
}

}  // namespace

std::vector<double> parameters(const std::vector<Vec3>& points, Parameterization how, bool closed) {
  const std::size_t steps = closed ? points.size() : points.size() - 1;
  std::vector<double> values(steps + 1, 0.0);
  for (std::size_t i = 0; i < steps; ++i) {
    const double distance = (points[(i + 1) % points.size()] - points[i]).norm();
    const double step = how == Parameterization::uniform ? 1.0
                        : how == Parameterization::chord ? distance
                                                         : std::sqrt(distance);
    values[i + 1] = values[i] + step;
  }
  const double total = values.back();
  for (double& value : values) value /= total;
  values.back() = 1.0;
  return values;
}

Vec3 end_derivative(const std::vector<Vec3>& points, const std::vector<double>& t, bool last,
                    const std::optional<Vec3>& direction) {
  const std::size_t n = points.size();
  // Indices from the end inward.
  const auto index = [&](std::size_t k) { return last ? n - 1 - k : k; };
  const auto slope = [&](std::size_t k) -> Vec3 {
    return (points[index(k + 1)] - points[index(k)]) / (t[index(k + 1)] - t[index(k)]);
  };
  Vec3 derivative = slope(0);
  if (n > 2) {
    const double h0 = std::abs(t[index(1)] - t[index(0)]), h1 = std::abs(t[index(2)] - t[index(1)]);
    derivative += (slope(0) - slope(1)) * (h0 / (h0 + h1));
  }
  if (direction) derivative = direction->normalized() * derivative.norm();
  return derivative;
}

std::vector<double> clamped_knots(const std::vector<double>& parameters) {
  std::vector<double> knots(3, parameters.front());
  knots.insert(knots.end(), parameters.begin(), parameters.end());
  knots.insert(knots.end(), 3, parameters.back());
  return knots;
}

Eigen::MatrixXd interpolate_clamped(const std::vector<double>& t, const Eigen::MatrixXd& data,
                                    const Eigen::RowVectorXd& first_derivative,
                                    const Eigen::RowVectorXd& last_derivative) {
  const Eigen::Index n = data.rows() - 1;
  const std::vector<double> knots = clamped_knots(t);
  Eigen::MatrixXd control(n + 3, data.cols());
  control.row(0) = data.row(0);
  control.row(n + 2) = data.row(n);
  control.row(1) = data.row(0) + (t[1] - t[0]) / 3.0 * first_derivative;
  control.row(n + 1) = data.row(n) - (t[at(n)] - t[at(n - 1)]) / 3.0 * last_derivative;
  const Eigen::Index unknowns = n - 1;  // control rows 2 .. n
  if (unknowns == 0) return control;
  std::vector<double> low(at(unknowns)), diagonal(at(unknowns)), high(at(unknowns));
  Eigen::MatrixXd right = data.middleRows(1, unknowns);
  for (Eigen::Index i = 0; i < unknowns; ++i) {
    // At the data point i + 1, a knot, three basis functions do not vanish: those of control rows i + 1, i +
    // 2, i + 3.
    BasisRow values{};
    basis(knots, 3, static_cast<int>(i) + 4, t[at(i + 1)], values);
    low[at(i)] = values[0];
    diagonal[at(i)] = values[1];
    high[at(i)] = values[2];
  }
  right.row(0) -= low[0] * control.row(1);
  right.row(unknowns - 1) -= high[at(unknowns - 1)] * control.row(n + 1);
  solve_tridiagonal(low, diagonal, high, right);
  control.middleRows(2, unknowns) = right;
  return control;
}

Eigen::MatrixXd interpolate_periodic(const std::vector<double>& t, const Eigen::MatrixXd& data) {
  const Eigen::Index n = data.rows();
  const double period = t.back() - t.front();
  // Knots of the periodic spline, three more on each side of the period.
  std::vector<double> knots;
  for (Eigen::Index i = -3; i <= n + 3; ++i) {
    const Eigen::Index k = wrapped(i, n), turns = (i - k) / n;
    knots.push_back(t[at(k)] + period * static_cast<double>(turns));
  }
  knots[at(n + 3)] = t.back();
  // The unknown row i stands in the middle of the three functions that live at data point i (rows i - 1, i, i
  // + 1).
  std::vector<double> low(at(n)), diagonal(at(n)), high(at(n));
  for (Eigen::Index i = 0; i < n; ++i) {
    BasisRow values{};
    basis(knots, 3, static_cast<int>(i) + 3, t[at(i)], values);
    low[at(i)] = values[0];
    diagonal[at(i)] = values[1];
    high[at(i)] = values[2];
  }
  // Cyclic corners by the Sherman-Morrison formula: one more column to solve.
  const double corner_low = low[0], corner_high = high[at(n - 1)];
  const double gamma = -diagonal[0];
  diagonal[0] -= gamma;
  diagonal[at(n - 1)] -= corner_low * corner_high / gamma;
  Eigen::MatrixXd right(n, data.cols() + 1);
  right.leftCols(data.cols()) = data;
  right.col(data.cols()).setZero();
  right(0, data.cols()) = gamma;
  right(n - 1, data.cols()) = corner_high;
  solve_tridiagonal(low, diagonal, high, right);
  const Eigen::VectorXd z = right.col(data.cols());
  const double denominator = 1.0 + z(0) + corner_low / gamma * z(n - 1);
  Eigen::MatrixXd rows = right.leftCols(data.cols());
  const Eigen::RowVectorXd share = (rows.row(0) + corner_low / gamma * rows.row(n - 1)) / denominator;
  rows -= z * share;
  // Cut open at the first parameter: value and derivative there are blends of three rows; all rows but the
  // outermost two on each side of the seam stay what they are.
  Eigen::MatrixXd control(n + 3, data.cols());
  const auto row = [&](Eigen::Index i) { return rows.row(wrapped(i, n)); };
  const auto knot = [&](Eigen::Index i) { return knots[at(i + 3)]; };  // knot(0) is the seam
  const auto blend = [&](Eigen::Index i, double a, double b, double s) -> Eigen::RowVectorXd {
    const double share_of_next = (s - a) / (b - a);
    return (1.0 - share_of_next) * row(i) + share_of_next * row(i + 1);
  };
  // de Boor points of the blossom: row i has the blossom knots (i-1, i, i+1).
  const double seam = knot(0);
  const Eigen::RowVectorXd before = blend(-1, knot(-2), knot(1), seam);  // blossom (-1, 0, 0)
  const Eigen::RowVectorXd after = blend(0, knot(-1), knot(2), seam);    // blossom (0, 0, 1)
  const double share_of_after = (seam - knot(-1)) / (knot(1) - knot(-1));
  control.row(0) = (1.0 - share_of_after) * before + share_of_after * after;
  control.row(1) = after;
  for (Eigen::Index i = 1; i < n; ++i) control.row(i + 1) = row(i);
  control.row(n + 1) = before;
  control.row(n + 2) = control.row(0);
  return control;
}

Curve interpolate(const std::vector<Vec3>& points, const std::vector<double>& t, const Vec3& first_derivative,
                  const Vec3& last_derivative) {
  return as_curve(clamped_knots(t), interpolate_clamped(t, as_matrix(points), first_derivative.transpose(),
                                                        last_derivative.transpose()));
}

Curve interpolate_closed(const std::vector<Vec3>& points, const std::vector<double>& t) {
  return as_curve(clamped_knots(t), interpolate_periodic(t, as_matrix(points)));
}

std::vector<double> clamped_integer_knots(int count, int degree) {
  std::vector<double> knots;
  knots.reserve(static_cast<std::size_t>(count) + static_cast<std::size_t>(degree) + 1);
  for (int i = 0; i < count + degree + 1; ++i) knots.push_back(std::clamp(i - degree, 0, count - degree));
  return knots;
}

Curve closed_uniform(const std::vector<Vec3>& points, const std::vector<double>& weights, int degree,
                     const std::function<double(int)>& knot) {
  const int n = static_cast<int>(points.size());
  Curve periodic;
  periodic.degree = degree;
  for (int i = -degree; i <= n + degree; ++i) periodic.knots.push_back(knot(i));
  for (int i = 0; i < n + degree; ++i) {
    const int k = wrapped(i - degree / 2, n);
    periodic.points.push_back(points[at(k)]);
    if (!weights.empty()) periodic.weights.push_back(weights[at(k)]);
  }
  Curve curve = sub_curve(periodic, periodic.first_parameter(), periodic.last_parameter());
  curve.points.back() = curve.points.front();
  if (curve.is_rational()) curve.weights.back() = curve.weights.front();
  return curve;
}

}  // namespace selvage::nurbs
