// Interpolating cubics against dense solves, published control points and invariances.
#include "nurbs/interpolate.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "nurbs/basis.h"

namespace selvage::nurbs {
namespace {

// The published jersey loop for yarn radius 1 (methods.md, 1).
std::vector<Vec3> jersey_points() {
  return {{-4, -3, -1.5}, {-1, 0, 0},    {-2, 3.5, 1.5}, {-3, 7, 0},   {0, 10, -1.5},
          {3, 7, 0},      {2, 3.5, 1.5}, {1, 0, 0},      {4, -3, -1.5}};
}

const std::vector<Parameterization> all = {Parameterization::uniform, Parameterization::chord,
                                           Parameterization::centripetal};

TEST(Interpolate, MeetsEveryDataPointAndEndDerivative) {
  const std::vector<Vec3> points = jersey_points();
  for (Parameterization how : all) {
    const std::vector<double> t = parameters(points, how);
    const Vec3 d0 = end_derivative(points, t, false, Vec3(1, 0, 0)), d1 = end_derivative(points, t, true);
    const Curve curve = interpolate(points, t, d0, d1);
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_LT((evaluate(curve, t[i]) - points[i]).norm(), 15e-12);
    EXPECT_LT((evaluate_jet(curve, 0.0).d1 - d0).norm(), 1e-11 * d0.norm());
    EXPECT_LT((evaluate_jet(curve, 1.0).d1 - d1).norm(), 1e-11 * d1.norm());
  }
}

TEST(Interpolate, AgreesWithADenseSolve) {
  const std::vector<Vec3> points = jersey_points();
  for (Parameterization how : all) {
    const std::vector<double> t = parameters(points, how);
    const Vec3 d0(3, -1, 2), d1(0.5, 4, 1);
    const Curve curve = interpolate(points, t, d0, d1);
    const int count = static_cast<int>(curve.points.size());
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count, count), right(count, 3);
    std::array<BasisRow, 3> rows{};
    for (int i = 0; i < count - 2; ++i) {
      const double s = t[static_cast<std::size_t>(i)];
      const int span = find_span(curve.knots, 3, count, s);
      basis_derivatives(curve.knots, 3, span, s, rows);
      for (int j = 0; j < 4; ++j) matrix(i, span - 3 + j) = rows[0][static_cast<std::size_t>(j)];
      right.row(i) = points[static_cast<std::size_t>(i)].transpose();
      for (int end = 0; end < 2; ++end)
        if (i == (end == 0 ? 0 : count - 3)) {
          for (int j = 0; j < 4; ++j)
            matrix(count - 2 + end, span - 3 + j) = rows[1][static_cast<std::size_t>(j)];
          right.row(count - 2 + end) = (end == 0 ? d0 : d1).transpose();
        }
    }
    const Eigen::MatrixXd dense = matrix.fullPivLu().solve(right);
    for (int i = 0; i < count; ++i)
      EXPECT_LT((dense.row(i).transpose() - curve.points[static_cast<std::size_t>(i)]).norm(), 1e-11);
  }
}

TEST(Interpolate, DefaultEndDerivativeIsTheParabolasOwn) {
  // Points of a parabola at uneven parameters: the whole cubic must be that parabola.
  const auto parabola = [](double s) { return Vec3(s, 3 * s * s - s, 0.5 * s * s); };
  std::vector<Vec3> points;
  const std::vector<double> t = {0, 0.1, 0.35, 0.7, 1.0};
  for (double s : t) points.push_back(parabola(s));
  const Curve curve =
      interpolate(points, t, end_derivative(points, t, false), end_derivative(points, t, true));
  for (double s = 0; s <= 1.0; s += 0.02) EXPECT_LT((evaluate(curve, s) - parabola(s)).norm(), 1e-13);
}

TEST(Interpolate, MotionOfTheDataMovesTheCurve) {
  const std::vector<Vec3> points = jersey_points();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  std::vector<Vec3> moved;
  for (const Vec3& p : points) moved.push_back(2.5 * (turn * p) + Vec3(3, 4, 5));
  for (Parameterization how : all) {
    const std::vector<double> t = parameters(points, how), tm = parameters(moved, how);
    const Curve a = interpolate(points, t, end_derivative(points, t, false), end_derivative(points, t, true));
    const Curve b = interpolate(moved, tm, end_derivative(moved, tm, false), end_derivative(moved, tm, true));
    for (double s = 0; s <= 1.0; s += 0.01)
      EXPECT_LT((2.5 * (turn * evaluate(a, s)) + Vec3(3, 4, 5) - evaluate(b, s)).norm(), 1e-11);
  }
}

TEST(Interpolate, ClosedCurveIsPeriodicThroughTheDataAndTwiceSmoothAtTheSeam) {
  std::vector<Vec3> points = {{5, 0, 0}, {3, 4, 1}, {0, 5, 0}, {-4, 3, -1}, {-2, -5, 0.5}, {3, -4, 0}};
  for (Parameterization how : all) {
    const std::vector<double> t = parameters(points, how, true);
    ASSERT_EQ(t.size(), points.size() + 1);
    const Curve curve = interpolate_closed(points, t);
    EXPECT_EQ(curve.points.front(), curve.points.back());
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_LT((evaluate(curve, t[i]) - points[i]).norm(), 1e-12);
    const CurveJet first = evaluate_jet(curve, 0.0), last = evaluate_jet(curve, 1.0);
    EXPECT_LT((first.d1 - last.d1).norm(), 1e-10 * first.d1.norm());
    EXPECT_LT((first.d2 - last.d2).norm(), 1e-9 * first.d2.norm());
    // The seam is nothing special: starting at another point gives the same curve.
    std::vector<Vec3> turned = points;
    std::rotate(turned.begin(), turned.begin() + 2, turned.end());
    const std::vector<double> tt = parameters(turned, how, true);
    const Curve other = interpolate_closed(turned, tt);
    for (double s = 0; s < 1.0; s += 0.01) {
      const double shifted = s + t[2] >= 1.0 ? s + t[2] - 1.0 : s + t[2];
      EXPECT_LT((evaluate(other, s) - evaluate(curve, shifted)).norm(), 1e-11);
    }
  }
}

TEST(Interpolate, TwoPointsAreAStraightLine) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 2, 3}};
  const std::vector<double> t = parameters(points, Parameterization::chord);
  const Curve curve =
      interpolate(points, t, end_derivative(points, t, false), end_derivative(points, t, true));
  for (double s = 0; s <= 1.0; s += 0.1) EXPECT_LT((evaluate(curve, s) - s * points[1]).norm(), 1e-15);
}

TEST(Interpolate, ClampingAPeriodicCurveLeavesIt) {
  Curve periodic;
  periodic.degree = 3;
  for (int i = 0; i <= 10; ++i) periodic.knots.push_back(i);
  const std::vector<Vec3> corners = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  for (std::size_t i = 0; i < 7; ++i) periodic.points.push_back(corners[i % 4]);
  const Curve clamp = sub_curve(periodic, 3, 7);
  EXPECT_EQ(clamp.points.size(), 7U);
  EXPECT_EQ(clamp.knots, (std::vector<double>{3, 3, 3, 3, 4, 5, 6, 7, 7, 7, 7}));
  for (double t = 3; t <= 7; t += 0.1) EXPECT_LT((evaluate(clamp, t) - evaluate(periodic, t)).norm(), 1e-14);
}

}  // namespace
}  // namespace selvage::nurbs
