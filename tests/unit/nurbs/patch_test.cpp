#include "nurbs/patch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "nurbs/conic.h"
#include "nurbs/divided.h"
#include "nurbs/sweep.h"

namespace selvage::nurbs {
namespace {

using std::numbers::pi;

// A torus reaches R sin(angle to the axis) + r along a direction.
TEST(BoxOfASurface, IsThatOfATorus) {
  const double big = 3, small = 0.5;
  for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(1, 2, 3), Vec3(-2, 0.1, 0.3)}) {
    const Vec3 z = axis.normalized(), x = z.unitOrthogonal(), middle(5, -7, 11);
    const Curve section = elliptic_arc(middle + big * x, small * x, small * z, 0, 2 * pi);
    const Surface torus = revolved(section, middle, z, 0, 2 * pi);
    Box3 box;
    extend(box, torus, 1e-9);
    for (int k = 0; k < 3; ++k) {
      const double reach = big * std::sqrt(1 - z[k] * z[k]) + small;
      EXPECT_NEAR(box.max()[k], middle[k] + reach, 2e-9);
      EXPECT_NEAR(box.min()[k], middle[k] - reach, 2e-9);
    }
  }
}

// A cubic net that swings: never smaller than the box of many points, and no larger than theirs but for their
// distance.
TEST(BoxOfASurface, HoldsItsPointsAndNoMore) {
  Surface s;
  s.degree_u = s.degree_v = 3;
  s.count_u = 7;
  s.count_v = 9;
  s.knots_u = {0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4};
  s.knots_v = {0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 6, 6, 6};
  for (int j = 0; j < s.count_v; ++j)
    for (int i = 0; i < s.count_u; ++i)
      s.points.emplace_back(i + std::sin(5.0 * j), j + std::cos(3.0 * i), std::sin(7.0 * i * j));
  Box3 box, control, sampled;
  extend(box, s, 1e-9);
  for (const Vec3& p : s.points) control.extend(p);
  for (const Vec3& p :
       evaluate_grid(s, divided(s.knots_u, s.degree_u, 200), divided(s.knots_v, s.degree_v, 200)))
    sampled.extend(p);
  EXPECT_TRUE(Box3(box.min().array() - 1e-9, box.max().array() + 1e-9).contains(sampled));
  EXPECT_TRUE(Box3(sampled.min().array() - 1e-3, sampled.max().array() + 1e-3).contains(box));
  EXPECT_LT(box.sizes().z(), 0.9 * control.sizes().z());
}

TEST(Divided, SpansIntoEqualParts) {
  EXPECT_EQ(divided({0, 0, 0, 1, 3, 3, 3}, 2, 2), (std::vector<double>{0, 0.5, 1, 2, 3}));
  EXPECT_EQ(divided({0, 1, 3}, std::vector<int>{1, 4}), (std::vector<double>{0, 1, 1.5, 2, 2.5, 3}));
}

}  // namespace
}  // namespace selvage::nurbs
