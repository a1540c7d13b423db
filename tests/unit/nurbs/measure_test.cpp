// Lengths: analytic values, and an effort that no weight can raise.
#include "nurbs/measure.h"

#include <gtest/gtest.h>

#include <cmath>

namespace selvage::nurbs {
namespace {

// From 0 to 3 along x, so that the length is 3 whatever the weights are.
Curve straight(const std::vector<double>& weights) {
  Curve curve;
  curve.degree = 3;
  curve.knots = {0, 0, 0, 0, 1, 1, 1, 1};
  curve.weights = weights;
  for (int i = 0; i < 4; ++i) curve.points.emplace_back(i, 0, 0);
  return curve;
}

TEST(ArcLength, HeavyWeightsCostABoundedEffort) {
  for (const double heavy : {1.0, 1e2, 1e5, 1e9, 1e12})
    for (std::size_t place = 0; place < 4; ++place) {
      std::vector<double> weights(4, 1.0);
      weights[place] = heavy;
      const Curve curve = straight(weights);
      int calls = 0;
      const double length = adaptive_integral(
          [&](double t) {
            ++calls;
            return evaluate_jet(curve, t).d1.norm();
          },
          0, 1, 1e-13);
      EXPECT_LE(calls, 70'000) << heavy << " at " << place;
      const double tolerance = heavy > 1e10 ? 1e-3 : 1e-7;
      EXPECT_NEAR(length, 3, tolerance) << heavy << " at " << place;
      EXPECT_NEAR(arc_length(curve), 3, tolerance) << heavy << " at " << place;
    }
}

TEST(ArcLength, NoiseAndInfinitiesCostABoundedEffort) {
  int calls = 0;
  const auto noise = [&](double t) {
    ++calls;
    return std::fmod(std::abs(1e7 * std::sin(1e9 * t)), 1.0);
  };
  const double sum = adaptive_integral(noise, 0, 1, 0);
  EXPECT_TRUE(sum >= 0 && sum <= 1) << sum;
  EXPECT_LE(calls, 70'000);
  calls = 0;
  const auto pole = [&](double t) {
    ++calls;
    return 1 / (t * t);
  };
  adaptive_integral(pole, 0, 1, 0);
  EXPECT_LE(calls, 70'000);
  calls = 0;
  const auto nothing = [&](double) {
    ++calls;
    return std::nan("");
  };
  EXPECT_TRUE(std::isnan(adaptive_integral(nothing, 0, 1, 0)));
  EXPECT_LE(calls, 24);
}

TEST(ArcLength, SmoothIntegralsAreExact) {
  EXPECT_NEAR(adaptive_integral([](double t) { return std::exp(t); }, 0, 1, 0), std::exp(1.0) - 1, 1e-14);
  EXPECT_NEAR(adaptive_integral([](double t) { return std::sqrt(t); }, 0, 1, 0), 2.0 / 3, 1e-12);
}

}  // namespace
}  // namespace selvage::nurbs
