// Splines near points and through derivatives: against the curves that the points were taken from.
#include "nurbs/smooth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "nurbs/hermite.h"
#include "nurbs/interpolate.h"

namespace selvage::nurbs {
namespace {

using std::numbers::pi;

std::vector<Vec3> helix_points(int count, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> off(-noise, noise);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double t = 4.0 * pi * i / (count - 1);
    points.emplace_back(std::cos(t) + off(random), std::sin(t) + off(random), 0.3 * t + off(random));
  }
  return points;
}

TEST(Smooth, KeepsTheErrorWithFewKnots) {
  const std::vector<Vec3> points = helix_points(400, 0.01, 3);
  std::size_t before = 0;
  for (const double error : {0.3, 0.1, 0.03, 0.02}) {
    const std::optional<Smoothed> smoothed = smooth(points, error, false);
    ASSERT_TRUE(smoothed.has_value()) << error;
    EXPECT_LE(smoothed->farthest, error);
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_LE((evaluate(smoothed->curve, smoothed->parameters[i]) - points[i]).norm(),
                error * (1.0 + 1e-9));
    }
    const auto [first, last] = std::minmax_element(smoothed->parameters.begin(), smoothed->parameters.end());
    EXPECT_EQ(*first, 0.0);
    EXPECT_EQ(*last, 1.0);
    EXPECT_GE(smoothed->curve.points.size(), before);
    before = smoothed->curve.points.size();
  }
  EXPECT_LT(before, 40U);
}

TEST(Smooth, ALineTakesNoKnot) {
  std::vector<Vec3> points;
  for (int i = 0; i < 50; ++i) points.emplace_back(0.2 * i, (i % 2) * 0.01, 0.0);
  const std::optional<Smoothed> smoothed = smooth(points, 0.02, false);
  ASSERT_TRUE(smoothed.has_value());
  EXPECT_EQ(smoothed->curve.points.size(), 4U);
}

TEST(Smooth, NothingSwingsBeyondThePoints) {
  // The noise of the last points draws their nearest places back: the curve ends with them.
  for (unsigned seed = 1; seed < 30; ++seed) {
    const std::vector<Vec3> points = helix_points(120, 0.02, seed);
    const std::optional<Smoothed> smoothed = smooth(points, 0.06, false);
    ASSERT_TRUE(smoothed.has_value()) << seed;
    for (int i = 0; i <= 2000; ++i) {
      const Vec3 p = evaluate(smoothed->curve, i / 2000.0);
      EXPECT_NEAR(std::hypot(p.x(), p.y()), 1.0, 0.1) << seed << ' ' << i;
    }
  }
}

// Points so near to each other that their noise is many steps long.
TEST(Smooth, NoiseLargerThanTheStepsIsSmoothedToo) {
  const std::vector<Vec3> points = helix_points(20000, 0.03, 2);
  const std::optional<Smoothed> smoothed = smooth(points, 0.06, false);
  ASSERT_TRUE(smoothed.has_value());
  EXPECT_LT(smoothed->curve.points.size(), 30U);
  for (int i = 1; i < 500; ++i) {
    const CurveJet jet = evaluate_jet(smoothed->curve, i / 500.0);
    EXPECT_NEAR(std::hypot(jet.position.x(), jet.position.y()), 1.0, 0.03);
    EXPECT_GT(jet.d1.z(), 0.0);  // nowhere back
  }
}

TEST(Smooth, RingsClose) {
  std::vector<Vec3> points;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> off(-0.01, 0.01);
  for (int i = 0; i < 100; ++i)
    points.emplace_back(2.0 * std::cos(2.0 * pi * i / 100) + off(random),
                        std::sin(2.0 * pi * i / 100) + off(random), off(random));
  const std::optional<Smoothed> smoothed = smooth(points, 0.04, true);
  ASSERT_TRUE(smoothed.has_value());
  const CurveJet first = evaluate_jet(smoothed->curve, 0.0), last = evaluate_jet(smoothed->curve, 1.0);
  EXPECT_EQ(first.position, last.position);
  EXPECT_LT((first.d1 - last.d1).norm(), 1e-9 * first.d1.norm());
  EXPECT_LT((first.d2 - last.d2).norm(), 1e-7 * first.d2.norm());
  EXPECT_LE(smoothed->farthest, 0.04);
}

TEST(Smooth, TooFewPointsForTheErrorAreTold) {
  EXPECT_FALSE(smooth(helix_points(12, 0.05, 1), 1e-4, false).has_value());
}

// The samples of a spline, at its knots and between them, are that spline.
TEST(Hermite, ASplineComesBackFromItsSamples) {
  const std::vector<Vec3> rows = helix_points(9, 0.2, 5);
  const std::vector<double> t = parameters(rows, Parameterization::chord);
  const Curve curve = interpolate(rows, t, end_derivative(rows, t, false), end_derivative(rows, t, true));
  std::vector<double> at;
  for (std::size_t i = 0; i + 1 < t.size(); ++i)
    for (int k = 0; k < static_cast<int>(i % 3) + 1; ++k)
      at.push_back(t[i] + (t[i + 1] - t[i]) * k / static_cast<double>(i % 3 + 1));
  at.push_back(1.0);
  std::vector<Vec3> points, derivatives;
  for (const double s : at) {
    const CurveJet jet = evaluate_jet(curve, s);
    points.push_back(jet.position);
    derivatives.push_back(jet.d1);
  }
  const Curve found = through_derivatives(at, points, derivatives);
  EXPECT_EQ(found.knots, curve.knots);
  ASSERT_EQ(found.points.size(), curve.points.size());
  for (std::size_t i = 0; i < found.points.size(); ++i)
    EXPECT_LT((found.points[i] - curve.points[i]).norm(), 1e-11) << i;
}

TEST(Hermite, KnotsStandTwiceWhereSecondDerivativesJump) {
  const std::vector<double> at = {0.0, 1.0, 2.0};
  const std::vector<Vec3> points = {Vec3(0, 0, 0), Vec3(1, 1, 0), Vec3(2, 0, 1)},
                          derivatives = {Vec3(1, 3, 0), Vec3(1, 0, 0), Vec3(1, -1, 2)};
  const Curve curve = through_derivatives(at, points, derivatives);
  EXPECT_EQ(curve.knots, (std::vector<double>{0, 0, 0, 0, 1, 1, 2, 2, 2, 2}));
  for (std::size_t i = 0; i < 3; ++i) {
    const CurveJet jet = evaluate_jet(curve, at[i]);
    EXPECT_LT((jet.position - points[i]).norm(), 1e-14);
    EXPECT_LT((jet.d1 - derivatives[i]).norm(), 1e-13);
  }
}

}  // namespace
}  // namespace selvage::nurbs
