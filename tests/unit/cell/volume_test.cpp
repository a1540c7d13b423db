// Volumes inside a box against closed forms, and against the body itself.
#include "cell/volume.h"

#include <gtest/gtest.h>

#include <numbers>

#include "unit/solid/bodies.h"

namespace selvage::cell {
namespace {

using test::straight;
using test::TubeForm;

using std::numbers::pi;
const TubeForm thin_tube{0.5, 0.5, 64, 4};

std::vector<double> volumes(const std::vector<yarn::Body>& bodies, const Box3& box) {
  Result<Cut> cut_up = cut(bodies, box, 0.001);
  EXPECT_TRUE(cut_up.ok()) << (cut_up.ok() ? "" : to_string(cut_up.error()));
  if (!cut_up) return {};
  const Result<Division> division = divide_faces(bodies, box, *cut_up);
  EXPECT_TRUE(division.ok()) << (division.ok() ? "" : to_string(division.error()));
  return division ? volumes_inside(bodies, box, *cut_up, *division) : std::vector<double>{};
}

yarn::Body ring(double radius) {
  return test::tube("ring", {radius, radius, 64, 96, true}, [&](double s, double x, double y) -> Vec3 {
    return Vec3((2 + x) * std::cos(2 * pi * s), (2 + x) * std::sin(2 * pi * s), y);
  });
}

TEST(Volumes, AcrossIsAreaTimesLength) {
  const yarn::Body a = straight("a", thin_tube, {0, 0.7, 0}, {1, 0, 0}, {0, 1, 0}, 8);
  const std::vector<double> found = volumes({a}, Box3(Vec3(-1, -2, -1), Vec3(1.3, 2, 1)));
  EXPECT_NEAR(found[0], 2.3 * a.end_area, 1e-8);
}

TEST(Volumes, AskewIsTheSame) {
  const Vec3 way = Vec3(1, 0.3, 0.1).normalized();
  const yarn::Body a = straight("a", thin_tube, Vec3::Zero(), way, {0, 1, 0}, 12);
  const std::vector<double> found = volumes({a}, Box3(Vec3(-1, -2, -2), Vec3(1.3, 2, 2)));
  EXPECT_NEAR(found[0], 2.3 / way.x() * a.end_area, 1e-8);
}

TEST(Volumes, PartsOfTheBoxAddUp) {
  const std::vector<yarn::Body> bodies = {ring(0.4),
                                          straight("a", thin_tube, {0, 0, 0}, {1, 0.2, 1}, {0, 1, 0}, 12)};
  const Vec3 low(-3, -3, -1.5), high(3, 3, 1.5);
  const std::vector<double> whole = volumes(bodies, Box3(low, high));
  EXPECT_NEAR(whole[0], bodies[0].volume, 1e-10);
  std::array<double, 2> sums{};
  const std::array<double, 3> xs{-3, 0.31, 3}, ys{-3, -0.17, 3}, zs{-1.5, 0.07, 1.5};
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j)
      for (std::size_t k = 0; k < 2; ++k) {
        const std::vector<double> part =
            volumes(bodies, Box3(Vec3(xs[i], ys[j], zs[k]), Vec3(xs[i + 1], ys[j + 1], zs[k + 1])));
        for (std::size_t body = 0; body < 2; ++body) sums[body] += part[body];
      }
  EXPECT_NEAR(sums[0], whole[0], 1e-7 * whole[0]);
  EXPECT_NEAR(sums[1], whole[1], 1e-7 * whole[1]);
}

TEST(Volumes, ARingCutOnOneSide) {
  const yarn::Body body = ring(0.4);
  // Most of the ring is inside, then the rest.
  const double most = volumes({body}, Box3(Vec3(-1.1, -3, -1), Vec3(3, 3, 1)))[0],
               rest = volumes({body}, Box3(Vec3(-3, -3, -1), Vec3(-1.1, 3, 1)))[0];
  EXPECT_GT(most, rest);
  EXPECT_NEAR(most + rest, body.volume, 1e-7 * body.volume);
}

TEST(Volumes, AnEndInsideCloses) {
  const yarn::Body a = straight("a", thin_tube, {0, 0, 0}, {1, 0.3, 0.2}, {0, 1, 0}, 2);
  EXPECT_NEAR(volumes({a}, Box3(Vec3(-2, -2, -2), Vec3(2, 2, 2)))[0], a.volume, 1e-9);
}

}  // namespace
}  // namespace selvage::cell
