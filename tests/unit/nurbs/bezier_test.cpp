// Plane Beziers: the fit through fixed points by two methods, and outlines that cross themselves.
#include "nurbs/bezier.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "nurbs/bezier_fit.h"
#include "nurbs/measure.h"

namespace selvage::nurbs {
namespace {

std::vector<Vec2> samples_of(const Bezier& curve, int n) {
  std::vector<Vec2> points;
  for (int i = 0; i <= n; ++i) points.push_back(evaluate(curve, static_cast<double>(i) / n));
  points.front() = curve.front();
  points.back() = curve.back();
  return points;
}

double apart(const Bezier& a, const Bezier& b) {
  double largest = 0;
  for (std::size_t k = 0; k < 4; ++k) largest = std::max(largest, (a[k] - b[k]).norm());
  return largest;
}

std::vector<Vec2> random_points(std::mt19937& random, int count, double size, const Vec2& origin) {
  std::uniform_real_distribution<double> value(-size, size);
  std::vector<Vec2> points;
  for (int i = 0; i < count; ++i) points.push_back(origin + Vec2(value(random), value(random)));
  return points;
}

// The same least squares as one dense system in all unknowns, by Householder reflections.
Bezier dense_fit(const std::vector<Vec2>& points) {
  const auto n = static_cast<Eigen::Index>(points.size()) - 1;
  Eigen::MatrixXd shares(n - 1, 2), rest(n - 1, 2);
  for (Eigen::Index i = 1; i < n; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(n);
    shares.row(i - 1) << 3 * t * std::pow(1 - t, 2), 3 * t * t * (1 - t);
    rest.row(i - 1) = (points[static_cast<std::size_t>(i)] - std::pow(1 - t, 3) * points.front() -
                       std::pow(t, 3) * points.back())
                          .transpose();
  }
  const Eigen::MatrixXd inner = shares.colPivHouseholderQr().solve(rest);
  return {points.front(), Vec2(inner.row(0)), Vec2(inner.row(1)), points.back()};
}

TEST(BezierFit, FindsTheCubicThatThePointsWereTakenFrom) {
  std::mt19937 random(1);
  for (int n : {3, 4, 7, 40, 1000}) {
    const std::vector<Vec2> control = random_points(random, 4, 10, Vec2(100, -30));
    const Bezier curve = {control[0], control[1], control[2], control[3]};
    const BezierFit fit = fit_bezier(samples_of(curve, n));
    EXPECT_LT(apart(fit.solved, curve), 1e-11) << n;
    EXPECT_LT(apart(fit.descended, curve), 1e-10) << n;
  }
}

TEST(BezierFit, BothMethodsAgreeWithADenseSolve) {
  std::mt19937 random(2);
  int most_steps = 0;
  for (int count = 4; count < 60; ++count) {
    for (const double size : {1e-3, 1.0, 1e6}) {
      const std::vector<Vec2> points = random_points(random, count, size, Vec2(3 * size, size));
      const Bezier reference = dense_fit(points);
      const BezierFit fit = fit_bezier(points);
      EXPECT_LT(apart(fit.solved, reference), 1e-12 * size) << count;
      EXPECT_LT(apart(fit.descended, reference), 1e-11 * size) << count;
      EXPECT_GT(fit.iterations, 0);
      most_steps = std::max(most_steps, fit.iterations);
    }
  }
  EXPECT_LT(most_steps, 200);
}

TEST(BezierFit, KeepsEndsAndTwoInnerPointsToTheBit) {
  const std::vector<Vec2> points = {{0, 72}, {3.2, 72.3}, {6, 73}, {7.8, 74.4}};
  const BezierFit fit = fit_bezier(points);
  EXPECT_EQ(fit.solved[0], points[0]);
  EXPECT_EQ(fit.solved[3], points[3]);
  EXPECT_LT((evaluate(fit.solved, 1.0 / 3) - points[1]).norm(), 1e-13);
  EXPECT_LT((evaluate(fit.solved, 2.0 / 3) - points[2]).norm(), 1e-13);
}

// Elevated by hand: the parabola's middle control point is 2 Q1 - (Q0 + Q2) / 2 = (1, 2) here.
TEST(BezierFit, OneInnerPointIsTheElevatedParabola) {
  const BezierFit fit = fit_bezier({{0, 0}, {1, 1}, {2, 0}});
  const Bezier expected = {Vec2(0, 0), Vec2(2.0 / 3, 4.0 / 3), Vec2(4.0 / 3, 4.0 / 3), Vec2(2, 0)};
  EXPECT_LT(apart(fit.solved, expected), 1e-15);
  EXPECT_LT(apart(fit.descended, expected), 1e-13);
  const BezierFit skew = fit_bezier({{5, 1}, {7, -3}, {4, 4}});
  EXPECT_LT(apart(skew.solved, skew.descended), 1e-12);
  // A parabola has no third difference.
  EXPECT_LT((skew.solved[3] - 3 * skew.solved[2] + 3 * skew.solved[1] - skew.solved[0]).norm(), 1e-13);
  EXPECT_LT((evaluate(skew.solved, 0.5) - Vec2(7, -3)).norm(), 1e-14);
}

TEST(BezierFit, NoInnerPointIsTheStraightLine) {
  const BezierFit fit = fit_bezier({{0, 0}, {3, 6}});
  EXPECT_LT(apart(fit.solved, {Vec2(0, 0), Vec2(1, 2), Vec2(2, 4), Vec2(3, 6)}), 1e-15);
  EXPECT_EQ(apart(fit.solved, fit.descended), 0);
  EXPECT_EQ(fit.iterations, 0);
}

TEST(BezierFit, CoincidentPointsAreNoTrouble) {
  const std::vector<Vec2> loop = {{0, 0}, {1, 1}, {1, 1}, {2, 0}, {0, 0}};  // closed, one point twice
  const BezierFit fit = fit_bezier(loop);
  EXPECT_LT(apart(fit.solved, dense_fit(loop)), 1e-13);
  EXPECT_LT(apart(fit.solved, fit.descended), 1e-11);
}

double largest_error(const BezierFit& fit, const std::vector<Vec2>& points) {
  double largest = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    largest = std::max(largest, (evaluate(fit.solved, fit.parameters[i]) - points[i]).norm());
  return largest;
}

// Shares of the polygon's length, and the dense solve with them.
TEST(BezierFit, ByChord) {
  const std::vector<Vec2> points = {{0, 0}, {3, 4}, {3, 6}, {4, 6}, {8, 9}};
  const BezierFit fit = fit_bezier(points, PointParameters::chord);
  const std::vector<double> shares = {0, 5.0 / 13, 7.0 / 13, 8.0 / 13, 1};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(fit.parameters[i], shares[i], 1e-15);
  Eigen::MatrixXd a(3, 2), b(3, 2);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double t = shares[static_cast<std::size_t>(i) + 1];
    a.row(i) << 3 * t * std::pow(1 - t, 2), 3 * t * t * (1 - t);
    b.row(i) = (points[static_cast<std::size_t>(i) + 1] - std::pow(t, 3) * points.back()).transpose();
  }
  const Eigen::MatrixXd inner = a.colPivHouseholderQr().solve(b);
  EXPECT_LT((fit.solved[1] - Vec2(inner.row(0))).norm() + (fit.solved[2] - Vec2(inner.row(1))).norm(), 1e-12);
  EXPECT_LT(apart(fit.solved, fit.descended), 1e-10);
  // One inner point: the parabola that is there at its share. Here B(3/4) = (3, 0).
  const BezierFit three = fit_bezier({{0, 0}, {3, 0}, {3, 1}}, PointParameters::chord);
  EXPECT_LT((evaluate(three.solved, 0.75) - Vec2(3, 0)).norm(), 1e-14);
  EXPECT_LT((three.solved[3] - 3 * three.solved[2] + 3 * three.solved[1] - three.solved[0]).norm(), 1e-13);
  EXPECT_LT(apart(three.solved, three.descended), 1e-12);
}

// Seven points of a known cubic at uneven parameters: with parameters as unknowns the cubic itself is found.
TEST(BezierFit, ByDistanceFindsTheCubicOfUnevenPoints) {
  const Bezier armhole = {Vec2(21.5, 70.4), Vec2(18.8, 61), Vec2(18.4, 52.5), Vec2(26, 49)};
  std::vector<Vec2> points;
  for (const double t : {0.0, 0.06, 0.1, 0.45, 0.6, 0.93, 1.0}) points.push_back(evaluate(armhole, t));
  EXPECT_GT(largest_error(fit_bezier(points), points), 1);
  const BezierFit fit = fit_bezier(points, PointParameters::distance);
  EXPECT_LT(largest_error(fit, points), 1e-12);
  EXPECT_LT(apart(fit.solved, armhole), 1e-10);

  // Ten wide, of C and S shape. Where the points tell little of the curve (four of five in its first tenth),
  // another cubic may pass within 1e-4 of all of them and is found instead.
  std::mt19937 random(6);
  std::uniform_real_distribution<double> share(0, 1);
  const auto between = [&](double least, double most) { return least + (most - least) * share(random); };
  int missed = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Bezier curve = {Vec2(0, 0), Vec2(0, 0), Vec2(0, 0), Vec2(10, 0)};
    for (const std::size_t i : {1, 2}) {
      curve[i][0] = i == 1 ? between(1, 4) : between(6, 9);
      curve[i][1] = between(-6, 6);
    }
    std::vector<double> at = {0, 1};
    for (int i = 0; i < 5; ++i) at.push_back(share(random));
    std::ranges::sort(at);
    std::vector<Vec2> taken;
    taken.reserve(at.size());
    for (const double t : at) taken.push_back(evaluate(curve, t));
    const BezierFit found = fit_bezier(taken, PointParameters::distance);
    const double error = largest_error(found, taken);
    EXPECT_LT(error, 1e-4) << trial;
    missed += error < 1e-9 ? 0 : 1;
    EXPECT_TRUE(std::ranges::is_sorted(found.parameters));
  }
  EXPECT_LE(missed, 9);
}

// What no cubic meets: no small change of the control points brings the curve nearer to the points.
TEST(BezierFit, ByDistanceIsLeast) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.3);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<Vec2> points;
    for (int i = 0; i <= 20; ++i)
      points.emplace_back(i + 0.2 * noise(random), 3 * std::sin(0.25 * i) + noise(random));
    const auto sum = [&](const Bezier& curve) {
      double squares = 0;
      for (std::size_t i = 1; i + 1 < points.size(); ++i)
        squares += (evaluate(curve, nearest_parameter(curve, points[i])) - points[i]).squaredNorm();
      return squares;
    };
    const BezierFit fit = fit_bezier(points, PointParameters::distance);
    const double least = sum(fit.solved);
    EXPECT_LE(least, sum(fit_bezier(points).solved));
    EXPECT_LE(least, sum(fit_bezier(points, PointParameters::chord).solved));
    constexpr double step = 1e-5;
    for (const std::size_t k : {1U, 2U})
      for (const Eigen::Index axis : {0, 1}) {
        Bezier more = fit.solved, less = fit.solved;
        more[k][axis] += step;
        less[k][axis] -= step;
        EXPECT_NEAR((sum(more) - sum(less)) / (2 * step), 0, 1e-7 * (1 + least));
        EXPECT_GT(sum(more) + sum(less), 2 * least);
      }
    EXPECT_LT(apart(fit.solved, fit.descended), 1e-9);
  }
}

TEST(TurningShape, OfTheCurveItself) {
  // y = x^3 about the middle turns by atan 3 each way, seen from its inflection; a parabola one way.
  const Bezier cubic = {Vec2(-1, -1), Vec2(-1.0 / 3, 1), Vec2(1.0 / 3, -1), Vec2(1, 1)};
  EXPECT_NEAR(turning(cubic).left, std::atan(3.0), 1e-14);
  EXPECT_NEAR(turning(cubic).right, std::atan(3.0), 1e-14);
  EXPECT_EQ(turning_shape(cubic), TurningShape::s);
  const Bezier parabola = fit_bezier({{0, 0}, {1, 1}, {2, 0}}).solved;
  EXPECT_EQ(turning(parabola).left, 0);
  EXPECT_NEAR(turning(parabola).right, 2 * std::atan(2.0), 1e-14);
  EXPECT_EQ(turning_shape(parabola), TurningShape::c);
  EXPECT_EQ(turning_shape(straight_bezier({0, 0}, {3, 1})), TurningShape::straight);
}

TEST(Bezier, RunsBack) {
  // Control points 0 4 -3 1: x' = 12 - 66 t + 66 t^2.
  const Bezier curve = {Vec2(0, 0), Vec2(4, 0), Vec2(-3, 0), Vec2(1, 0)};
  const double half = std::sqrt(0.25 - 12.0 / 66);
  const auto x = [](double t) { return 12 * t - 33 * t * t + 22 * t * t * t; };
  EXPECT_NEAR(run_back(curve, 0, 1), x(0.5 - half) - x(0.5 + half), 1e-14);
  EXPECT_EQ(run_back(curve, 0, 0.2), 0);
  EXPECT_EQ(run_back(straight_bezier({0, 0}, {3, 1}), 0, 1), 0);
}

TEST(TurningShape, ByTheSignOfTheTurning) {
  EXPECT_EQ(turning_shape({{0, 0}, {1, 0}, {2, 1}, {2, 2}}), TurningShape::c);
  EXPECT_EQ(turning_shape({{0, 0}, {1, 0}, {2, -1}, {2, -2}}), TurningShape::c);
  EXPECT_EQ(turning_shape({{0, 0}, {1, 0}, {2, 1}, {3, 1}}), TurningShape::s);
  EXPECT_EQ(turning_shape({{0, 0}, {1, 0.1}, {2, 0.2}, {3, 0.3}}), TurningShape::straight);
  EXPECT_EQ(turning_shape({{0, 0}, {1, 0}, {2, 0}, {3, 1}}), TurningShape::c);
  EXPECT_EQ(turning_shape({{0, 0}, {1, 1}}), TurningShape::straight);
}

// The area under a cubic Bezier in control points (integrated by hand), against the quadrature.
TEST(Bezier, SweptAreaIsTheIntegral) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const std::vector<Vec2> p = random_points(random, 4, 1, Vec2::Zero());
    const auto turn = [&](std::size_t i, std::size_t j) { return p[i].x() * p[j].y() - p[i].y() * p[j].x(); };
    const double by_hand =
        (6 * turn(0, 1) + 3 * turn(0, 2) + turn(0, 3) + 3 * turn(1, 2) + 3 * turn(1, 3) + 6 * turn(2, 3)) /
        20;
    EXPECT_NEAR(swept_area({p[0], p[1], p[2], p[3]}, Vec2::Zero()), by_hand, 1e-14);
  }
}

TEST(Bezier, BoxHoldsTheCurveTightly) {
  std::mt19937 random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const std::vector<Vec2> p = random_points(random, 4, 1, Vec2::Zero());
    const Bezier curve = {p[0], p[1], p[2], p[3]};
    Box2 seen;
    for (int i = 0; i <= 20'000; ++i) seen.extend(evaluate(curve, i / 20'000.0));
    const Box2 box = bounds(curve);
    EXPECT_LT((box.min() - seen.min()).cwiseAbs().maxCoeff(), 1e-7);
    EXPECT_LT((box.max() - seen.max()).cwiseAbs().maxCoeff(), 1e-7);
  }
}

TEST(Bezier, NearestPointIsNoFartherThanAnySample) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const std::vector<Vec2> p = random_points(random, 5, 1, Vec2::Zero());
    const Bezier curve = {p[0], p[1], p[2], p[3]};
    const double t = nearest_parameter(curve, p[4]);
    const double found = (evaluate(curve, t) - p[4]).norm();
    for (int i = 0; i <= 5000; ++i) EXPECT_LE(found, (evaluate(curve, i / 5000.0) - p[4]).norm() + 1e-15);
    EXPECT_LT(
        (evaluate(curve, nearest_parameter(curve, evaluate(curve, 0.3141))) - evaluate(curve, 0.3141)).norm(),
        1e-14);
  }
}

std::vector<Bezier> polygon(const std::vector<Vec2>& corners) {
  std::vector<Bezier> outline;
  for (std::size_t i = 0; i < corners.size(); ++i)
    outline.push_back(straight_bezier(corners[i], corners[(i + 1) % corners.size()]));
  return outline;
}

TEST(Crossing, NoneInSimpleOutlines) {
  EXPECT_FALSE(find_crossing(polygon({{0, 0}, {4, 0}, {4, 3}})));
  EXPECT_FALSE(find_crossing(polygon({{0, 0}, {4, 0}, {4, 3}, {2, 0.001}, {0, 3}})));
  // Corners in a straight line, and a very sharp one.
  EXPECT_FALSE(find_crossing(polygon({{0, 0}, {1, 0}, {2, 0}, {1, 1}})));
  EXPECT_FALSE(find_crossing(polygon({{0, 0}, {1, 0}, {0, 1e-4}})));
  // A lens: both curves share both ends. A drop: one curve, closed.
  EXPECT_FALSE(find_crossing({{Vec2(0, 0), Vec2(1, -1), Vec2(2, -1), Vec2(3, 0)},
                              {Vec2(3, 0), Vec2(2, 1), Vec2(1, 1), Vec2(0, 0)}}));
  EXPECT_FALSE(find_crossing({{Vec2(0, 0), Vec2(3, 1), Vec2(-1, 3), Vec2(0, 0)}}));
}

TEST(Crossing, FoundWhereItIs) {
  const auto bow = find_crossing(polygon({{0, 0}, {2, 2}, {2, 0}, {0, 2}}));
  ASSERT_TRUE(bow);
  EXPECT_EQ(bow->a, 0U);
  EXPECT_EQ(bow->b, 2U);
  EXPECT_LT((bow->at - Vec2(1, 1)).norm(), 1e-12);

  // The loop of a single cubic: by symmetry it meets itself on x = 0.
  const auto loop =
      find_crossing({{Vec2(-1, 0), Vec2(3, 3), Vec2(-3, 3), Vec2(1, 0)}, straight_bezier({1, 0}, {-1, 0})});
  ASSERT_TRUE(loop);
  EXPECT_EQ(loop->a, loop->b);
  EXPECT_NEAR(loop->at.x(), 0, 1e-8);

  // A neighbour's curve comes back through the line that it left: y of the cubic is 9 t (1 - t) (1 - 2 t).
  const auto back =
      find_crossing({straight_bezier({0, 0}, {3, 0}), {Vec2(3, 0), Vec2(2, 3), Vec2(1, -3), Vec2(0, 0)}});
  ASSERT_TRUE(back);
  EXPECT_LT((back->at - Vec2(1.5, 0)).norm(), 1e-8);
}

TEST(Crossing, TouchingCounts) {
  // A corner on a side.
  EXPECT_TRUE(find_crossing(polygon({{0, 0}, {4, 0}, {4, 3}, {2, 0}, {0, 3}})));
  // A line run back over itself, by neighbours and by others.
  EXPECT_TRUE(find_crossing(polygon({{0, 0}, {4, 0}, {2, 0}, {2, 2}})));
  EXPECT_TRUE(find_crossing(polygon({{0, 0}, {4, 0}})));
  EXPECT_TRUE(find_crossing(polygon({{0, 0}, {1, 0}, {1, 1}, {1, 0}, {2, 0}, {2, -1}, {0, -1}})));
  // A curve that touches a line from above, and one a little higher that does not.
  for (const double height : {0.0, 1e-6}) {
    std::vector<Bezier> outline = polygon({{0, 0}, {4, 0}, {4, 2}, {0, 2}});
    outline[2] = {Vec2(4, 2), Vec2(3, -2.0 / 3 + height), Vec2(1, -2.0 / 3 + height), Vec2(0, 2)};
    EXPECT_EQ(find_crossing(outline).has_value(), height == 0.0) << height;
  }
}

// A comb of ten thousand teeth: every pair at once would be 10^8.
TEST(Crossing, LongOutlines) {
  std::vector<Vec2> corners;
  for (int i = 0; i < 5000; ++i) {
    corners.emplace_back(i, 0);
    corners.emplace_back(i + 0.5, 10);
  }
  corners.emplace_back(4999, -1);
  corners.emplace_back(0, -1);
  EXPECT_FALSE(find_crossing(polygon(corners)));
  corners[1] = Vec2(3000.2, 10);
  EXPECT_TRUE(find_crossing(polygon(corners)));
}

}  // namespace
}  // namespace selvage::nurbs
