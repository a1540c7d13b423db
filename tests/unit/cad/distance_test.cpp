// Distances between surfaces against answers that are known: cylinders, parallel sheets, and the same surface
// in another form, whose distance is none.
#include "cad/distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "unit/cad/surfaces.h"

namespace selvage::cad {
namespace {

using nurbs::Surface;
using namespace test;

Reach both_ways(const Surface& a, const Surface& b, double enough) {
  const Reach there = distance_to(a, domain(a), SurfaceSet({&b}), enough);
  const Reach back = distance_to(b, domain(b), SurfaceSet({&a}), enough);
  return there.at_most >= back.at_most ? there : back;
}

// The largest distance of points of a on a fine grid to the points of b on one.
double sampled(const Surface& a, const Surface& b) {
  const auto grid = [](const Surface& s, int count) {
    std::vector<double> u, v;
    for (int k = 0; k <= count; ++k) {
      u.push_back(s.first_u() + (s.last_u() - s.first_u()) * k / count);
      v.push_back(s.first_v() + (s.last_v() - s.first_v()) * k / count);
    }
    return nurbs::evaluate_grid(s, u, v);
  };
  const std::vector<Vec3> from = grid(a, 25), to = grid(b, 400);
  double most = 0;
  for (const Vec3& p : from) {
    double least = 1e300;
    for (const Vec3& q : to) least = std::min(least, (p - q).squaredNorm());
    most = std::max(most, least);
  }
  return std::sqrt(most);
}

TEST(Distance, OfTheSameSurfaceInAnotherFormIsRounding) {
  const Surface tube = wavy_tube();
  const Surface round = cylinder(1.5, 4);
  for (const Surface& s : {tube, round, sheet()}) {
    for (const Surface& form : {s, swapped(s), backward_v(s), swapped(backward_v(s)), stretched(s, 7.3, -2),
                                refined_v(s, {0.11, 0.5, 0.77}), swapped(refined_v(backward_v(s), {0.3}))}) {
      const Reach reach = both_ways(s, form, 1e-11);
      EXPECT_LE(reach.at_most, 1e-12);
    }
  }
}

TEST(Distance, SeamsDoNotMatter) {
  for (const double at : {0.25, 0.3, 0.81}) {
    EXPECT_LE(both_ways(wavy_tube(), reseamed(wavy_tube(), at), 1e-11).at_most, 1e-12) << at;
    EXPECT_LE(both_ways(cylinder(1.5, 4), reseamed(cylinder(1.5, 4), at), 1e-11).at_most, 1e-11) << at;
  }
}

TEST(Distance, PiecesTogetherAreTheWhole) {
  for (const Surface& whole : {wavy_tube(), cylinder(1.5, 4), sheet()}) {
    const Surface a = cut_v(whole, 0, 0.37), b = cut_v(whole, 0.37, 1);
    const SurfaceSet pieces({&a, &b});
    EXPECT_LE(distance_to(whole, domain(whole), pieces, 1e-11).at_most, 1e-11);
    // One piece alone is not: the far end of the other one is a long way off.
    const Reach missing = distance_to(whole, domain(whole), SurfaceSet({&a}), 1e-11);
    EXPECT_GT(missing.at_least, 0.1);
    EXPECT_GE(missing.at_most, missing.at_least);
  }
}

TEST(Distance, OfCylinders) {
  // One inside the other, about the same axis: the difference of the radii, in every point.
  const Reach radii = both_ways(cylinder(1, 3), cylinder(1.1, 3), 1e-9);
  EXPECT_LE(radii.at_least, 0.1 + 1e-12);
  EXPECT_GE(radii.at_most, 0.1 - 1e-12);
  EXPECT_NEAR(radii.at_least, 0.1, 0.0015);  // certified within a hundredth
  EXPECT_LE(radii.at_most, 0.111);           // within a tenth of what was found
  // Moved aside by d: the point that is farthest is d away.
  const Reach aside = both_ways(cylinder(1, 3), cylinder(1, 3, 0.01), 1e-9);
  EXPECT_LE(aside.at_least, 0.01 + 1e-12);
  EXPECT_GE(aside.at_least, 0.0098);
  EXPECT_GE(aside.at_most, 0.01 - 1e-12);
  EXPECT_LE(aside.at_most, 0.0111);
  // Longer by one: the end's outline is one away.
  const Surface longer = cylinder(1, 4), shorter = cylinder(1, 3);
  const Reach over = distance_to(longer, domain(longer), SurfaceSet({&shorter}), 1e-9);
  EXPECT_LE(over.at_least, 1 + 1e-12);
  EXPECT_GE(over.at_least, 0.9);
  EXPECT_GE(over.at_most, 1 - 1e-12);
  EXPECT_LE(over.at_most, 1.11);
  EXPECT_LE(distance_to(shorter, domain(shorter), SurfaceSet({&longer}), 1e-9).at_most, 1e-12);
}

TEST(Distance, LiesBetweenItsBoundsWhereTheParametersAreOthers) {
  Surface bent = sheet();
  for (Vec3& p : bent.points) p.z() += 0.03 * p.x() * p.x();
  for (double& knot : bent.knots_u) knot = knot * knot;  // no affine change
  const Surface flat = sheet();
  const Reach reach = distance_to(bent, domain(bent), SurfaceSet({&flat}), 1e-9);
  // The points of a grid are nearer to each other than half its step and some rounding.
  const double truth = sampled(bent, flat);
  EXPECT_LE(reach.at_least, truth + 0.003);
  EXPECT_GE(reach.at_most, truth - 0.003);
  EXPECT_LE(reach.at_most, 1.4 * reach.at_least);
}

TEST(Distance, OfTheSmallestChange) {
  Surface changed = refined_v(wavy_tube(), {0.31});
  changed.point(4, 7).z() += 1e-9;
  const Reach reach = both_ways(wavy_tube(), changed, 1e-11);
  EXPECT_GT(reach.at_least, 1e-11);
  EXPECT_LE(reach.at_most, 1e-9);
}

}  // namespace
}  // namespace selvage::cad
