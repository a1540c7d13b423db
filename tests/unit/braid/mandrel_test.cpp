#include "braid/mandrel.h"

#include <gtest/gtest.h>

#include <cmath>

namespace selvage::fabric {
namespace {

TEST(Mandrel, CarriesWithTheDerivative) {
  const std::vector<MandrelRow> rows = {{Vec3(0, 0, 0), 3.0}, {Vec3(0, 1, 8), 3.5}, {Vec3(2, 2, 16), 2.5}};
  const Result<Mandrel> mandrel = Mandrel::make(rows, {1, 1});
  ASSERT_TRUE(mandrel.ok());
  EXPECT_FALSE(mandrel->is_straight());
  const double radius = 3.0;
  const auto tube = [&](double t) {  // a helix that rises in the wall
    const double r = radius + 0.1 * std::sin(t), angle = 0.8 * t;
    return Vec3(r * std::cos(angle), r * std::sin(angle), 2.0 * t);
  };
  for (const double t : {0.4, 1.7, 3.9, 6.5}) {
    const double h = 1e-5;
    const auto at = [&](double s) {
      return mandrel->carried(tube(s), (tube(s + h) - tube(s - h)) / (2.0 * h), radius);
    };
    const Vec3 slope = (at(t + h).position - at(t - h).position) / (2.0 * h);
    EXPECT_LT((at(t).derivative - slope).norm(), 1e-5) << t;
  }
  const Result<Mandrel> folded =
      Mandrel::make({{Vec3(0, 0, 0), 9.0}, {Vec3(3, 0, 3), 9.0}, {Vec3(0, 0, 6), 9.0}}, {4, 1});
  ASSERT_FALSE(folded.ok());
  EXPECT_EQ(folded.error().place.line, 4);
}

}  // namespace
}  // namespace selvage::fabric
