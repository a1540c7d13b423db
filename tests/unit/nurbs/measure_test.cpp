// Lengths: analytic values, and an effort that no weight can raise.
#include "nurbs/measure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "nurbs/interpolate.h"

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

Surface wavy(int degree_u, int degree_v, bool is_rational) {
  Surface s;
  s.degree_u = degree_u;
  s.degree_v = degree_v;
  s.count_u = degree_u + 4;
  s.count_v = degree_v + 5;
  s.knots_u = clamped_integer_knots(s.count_u, degree_u);
  s.knots_v = clamped_integer_knots(s.count_v, degree_v);
  for (int j = 0; j < s.count_v; ++j)
    for (int i = 0; i < s.count_u; ++i) {
      s.points.emplace_back(i + 0.3 * std::sin(5.0 * j), j + 0.2 * std::cos(3.0 * i),
                            std::sin(1.0 + 7.0 * i * j));
      if (is_rational) s.weights.push_back(1.0 + 0.3 * std::sin(i + 2.0 * j));
    }
  return s;
}

// The same integrals from two places in each direction of many cells, which no knot divides: of fourth order.
Moments summed(const Surface& s, const Vec3& origin) {
  constexpr int cells = 80;
  Moments sum;
  const double side_u = s.last_u() / cells, side_v = s.last_v() / cells;
  const auto place = [](int k) { return k / 2 + 0.5 + (k % 2 == 0 ? -0.5 : 0.5) / std::sqrt(3.0); };
  for (int j = 0; j < 2 * cells; ++j)
    for (int i = 0; i < 2 * cells; ++i) {
      const SurfaceJet jet = evaluate_jet(s, side_u * place(i), side_v * place(j));
      const Vec3 position = jet.position - origin, normal = 0.25 * side_u * side_v * jet.du.cross(jet.dv);
      const double flux = position.dot(normal);
      sum += {normal.norm(), normal, flux / 3, flux / 4 * position};
    }
  return sum;
}

// A quarter of a cylinder, by weights of the same arc that differ more and more (Piegl and Tiller 6.7): the
// flux about a point of the axis is a third of r times the area.
TEST(VolumeFlux, OfAnArcWhoseWeightsDiffer) {
  for (const double k : {1.0, 2.0, 4.0, 8.0}) {
    Surface wall;
    wall.degree_u = 2;
    wall.degree_v = 1;
    wall.count_u = 3;
    wall.count_v = 2;
    wall.knots_u = {0, 0, 0, 1, 1, 1};
    wall.knots_v = {0, 0, 1, 1};
    for (const double z : {0.0, 1.0}) {
      wall.points.insert(wall.points.end(), {Vec3(1, 0, z), Vec3(1, 1, z), Vec3(0, 1, z)});
      wall.weights.insert(wall.weights.end(), {1.0, k * std::numbers::sqrt2 / 2, k * k});
    }
    EXPECT_NEAR(std::abs(volume_flux(wall, Vec3::Zero())), std::numbers::pi / 6, 1e-13) << k;
  }
}

TEST(MomentsOfAFace, AreThoseOfADenseSum) {
  const Vec3 origin(0.5, -2, 1);
  for (const bool is_rational : {false, true})
    for (const int degree_u : {2, 3, 4})
      for (const int degree_v : {1, 2, 3, 5}) {
        const Surface s = wavy(degree_u, degree_v, is_rational);
        const Moments ours = moments(s, origin), dense = summed(s, origin);
        const auto what = [&] {
          return testing::Message() << degree_u << " x " << degree_v << (is_rational ? " rational" : "");
        };
        const double near = 1e-5 * dense.area;
        EXPECT_NEAR(ours.area, dense.area, near) << what();
        EXPECT_NEAR((ours.area_vector - dense.area_vector).norm(), 0, near) << what();
        EXPECT_NEAR(ours.volume, dense.volume, 5 * near) << what();
        EXPECT_NEAR((ours.first - dense.first).norm(), 0, 20 * near) << what();
        EXPECT_NEAR(volume_flux(s, origin), ours.volume, 1e-9 * dense.area) << what();
      }
}

}  // namespace
}  // namespace selvage::nurbs
