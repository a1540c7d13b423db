// Overlaps and gaps against closed forms.
#include <gtest/gtest.h>

#include <numbers>

#include "contact/contact.h"
#include "unit/solid/bodies.h"

namespace selvage::contact {
namespace {

using test::straight;
using test::TubeForm;

constexpr double pi = std::numbers::pi;

Contacts check(const std::vector<yarn::Body>& bodies, int threads = 1) {
  ContactOptions options;
  options.threads = threads;
  Result<Contacts> result = find_contacts(bodies, options);
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : to_string(result.error()));
  return result.ok() ? *result : Contacts{};
}

yarn::Body moved(yarn::Body body, const Vec3& by) {
  for (nurbs::Surface* s : {&body.surface, &body.start.surface, &body.end.surface})
    for (Vec3& p : s->points) p += by;
  for (Vec3& p : body.axis.points) p += by;
  body.start.origin += by;
  body.end.origin += by;
  return body;
}

TubeForm round(double radius) {
  return {radius, radius, 64, 4};
}

// One overlap of this depth, which moving b by a little more ends and by a little less does not.
void expect_overlap(const yarn::Body& a, const yarn::Body& b, double depth, const char* what) {
  SCOPED_TRACE(what);
  const Contacts result = check({a, b});
  ASSERT_EQ(result.list.size(), 1U);
  const Contact& overlap = result.list[0];
  EXPECT_EQ(overlap.a, 0U);
  EXPECT_EQ(overlap.b, 1U);
  EXPECT_NEAR(overlap.depth(), depth, 0.01 * depth);
  EXPECT_NEAR(overlap.direction.norm(), 1.0, 1e-9);
  EXPECT_FALSE(result.min_gap.has_value());
  const Contacts apart = check({a, moved(b, 1.01 * overlap.depth() * overlap.direction)});
  EXPECT_TRUE(apart.list.empty());
  const Contacts still = check({a, moved(b, 0.985 * overlap.depth() * overlap.direction)});
  EXPECT_FALSE(still.list.empty());
  // The other way round the same.
  const Contacts swapped = check({b, a});
  ASSERT_EQ(swapped.list.size(), 1U);
  EXPECT_NEAR(swapped.list[0].depth(), depth, 0.01 * depth);
}

TEST(Overlaps, CrossingFlatYarns) {
  // Ellipses 0.8 x 0.2 that lie on each other: half heights add up; one on edge: half width and half height.
  const TubeForm flat{0.4, 0.1, 64, 4};
  const yarn::Body a = straight("a", flat, Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 4.0);
  for (double distance : {0.198, 0.19, 0.15}) {
    expect_overlap(a, straight("b", flat, {0, 0, distance}, {0, 1, 0}, {1, 0, 0}, 4.0), 0.2 - distance,
                   "flat");
    expect_overlap(a, straight("b", flat, {0, 0, distance + 0.3}, {0, 1, 0}, {0, 0, 1}, 4.0), 0.2 - distance,
                   "on edge");
  }
  // Turned by 30 degrees about its own axis: the support of an ellipse in the direction of the common normal.
  const double c = std::cos(pi / 6.0), s = std::sin(pi / 6.0), support = std::hypot(0.4 * s, 0.1 * c);
  expect_overlap(a, straight("b", flat, {0, 0, 0.1 + support - 0.02}, {0, 1, 0}, {c, 0, s}, 4.0), 0.02,
                 "turned");
}

TEST(Overlaps, SeveralPlacesAreSeveralOverlaps) {
  // A wave of amplitude 0.5 over a straight yarn: three crests of the control net, each dips in.
  const yarn::Body wave = test::tube("wave", {0.2, 0.2, 32, 61}, [](double t, double u, double v) -> Vec3 {
    const double phi = 6.0 * pi * t, slope = 0.5 * 6.0 * pi / 12.0 * std::sin(phi);
    const Vec3 normal = Vec3(slope, 0, 1).normalized();  // of z = -0.5 cos(phi), nearly
    return Vec3(12.0 * t, 0, -0.5 * std::cos(phi)) + u * Vec3(-slope, 0, 1).normalized() + v * Vec3(0, 1, 0) +
           0.0 * normal;
  });
  const yarn::Body floor = straight("floor", {0.5, 0.5, 64, 4}, {6, 0, -1.15}, {1, 0, 0}, {0, 1, 0}, 14.0);
  const Contacts result = check({floor, wave});
  ASSERT_EQ(result.list.size(), 4U);  // phi = 0, 2 pi, 4 pi, 6 pi
  std::vector<double> places;
  for (const Contact& o : result.list) {
    places.push_back(o.at.x());
    EXPECT_GT(o.depth(), 0.03);
    EXPECT_LT(o.depth(), 0.06);
  }
  std::sort(places.begin(), places.end());
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(places[k], 4.0 * static_cast<double>(k), 0.1);
}

TEST(Overlaps, TouchingIsNoOverlap) {
  const yarn::Body a = straight("a", round(0.5), Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 6.0);
  // The curve of a control circle touches its own tangents at the middles of the polygon's sides: exactly
  // 0.5.
  for (const Vec3& along : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, 1, 0)}) {
    const yarn::Body b = straight("b", round(0.5), {0, 0, 1.0}, along, {0, 0, 1}, 6.0);
    const Contacts result = check({a, b});
    for (const Contact& o : result.list) EXPECT_LT(o.depth(), 2e-6);  // as round as the curve is
    if (result.list.empty()) {
      ASSERT_TRUE(result.min_gap.has_value());
      EXPECT_LT(*result.min_gap, 2e-6);
    }
  }
  // Faces that lie in one plane: end to end.
  const Contacts ends = check({a, moved(a, {6, 0, 0})});
  for (const Contact& o : ends.list) EXPECT_LT(o.depth(), 1e-12);
}

TEST(Overlaps, TheSameWithAnyNumberOfThreads) {
  std::vector<yarn::Body> bodies;
  for (int i = 0; i < 6; ++i) {
    bodies.push_back(
        straight("x", {0.4, 0.1, 16, 8}, {0, i - 2.5, 0.095 + 0.0025 * i}, {1, 0, 0}, {0, 1, 0}, 8.0));
    bodies.push_back(straight("y", {0.4, 0.1, 16, 8}, {i - 2.5, 0, -0.095}, {0, 1, 0}, {1, 0, 0}, 8.0));
  }
  const Contacts one = check(bodies), four = check(bodies, 4);
  ASSERT_EQ(one.list.size(), four.list.size());
  EXPECT_EQ(one.list.size(),
            36U - 12U);  // 0.19, 0.1925, 0.195, 0.1975, and apart: 0.2 (touching), 0.2025
  for (std::size_t k = 0; k < one.list.size(); ++k) {
    EXPECT_EQ(one.list[k].a, four.list[k].a);
    EXPECT_EQ(one.list[k].depth(), four.list[k].depth());
    EXPECT_EQ(one.list[k].at, four.list[k].at);
  }
  EXPECT_EQ(one.min_gap, four.min_gap);
}

}  // namespace
}  // namespace selvage::contact
