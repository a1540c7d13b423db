// Lenos and puckers: the shapes by themselves.
#include <gtest/gtest.h>

#include "weave/leno_shape.h"
#include "weave/pucker_shape.h"

namespace selvage::fabric {
namespace {

TEST(Leno, DerivativesAreThoseOfItsPoints) {
  const LenoShape shape{false, 1.3, 0.4, 0.35, 0.2, 0.3};
  for (const bool full : {false, true}) {
    LenoShape one = shape;
    one.full = full;
    for (const bool is_doup : {false, true})
      for (const double t : {-0.4, 0.0, 0.13, 0.5, 1.7}) {
        const double h = 1e-6;
        const Vec3 slope =
            (leno_point(one, is_doup, t + h).position - leno_point(one, is_doup, t - h).position) / (2.0 * h);
        EXPECT_LT((slope - leno_point(one, is_doup, t).derivative).norm(), 1e-8);
      }
  }
}

TEST(Pucker, NormalsAreThoseOfTheSurface) {
  const PuckerShape shape{6.0, 0.7, 1.0, 0.4, 5, 8};
  for (const double x : {0.0, 0.7, 2.9})
    for (const double y : {0.3, 1.9, 2.6, 3.7, 5.3}) {
      const double h = 1e-6;
      const auto on = [&](double dx, double dy) { return shape.carried(Vec3(x + dx, y + dy, 0.0)); };
      const Vec3 across = (on(h, 0) - on(-h, 0)).cross(on(0, h) - on(0, -h)).normalized();
      EXPECT_LT((across - shape.normal(Vec3(x, y, 0.0))).norm(), 1e-8);
    }
  EXPECT_EQ(shape.carried(Vec3(1.0, 0.2, 0.1)), Vec3(1.0, 0.2, 0.1));  // among tight warps
}

}  // namespace
}  // namespace selvage::fabric
