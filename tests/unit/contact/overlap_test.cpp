// Overlaps and gaps against closed forms.
#include <gtest/gtest.h>

#include <numbers>

#include "contact/contact.h"
#include "unit/solid/bodies.h"

namespace selvage::contact {
namespace {

using test::moved;
using test::straight;
using test::TubeForm;

using std::numbers::pi;

Contacts check(const std::vector<yarn::Body>& bodies, int threads = 1) {
  ContactOptions options;
  options.threads = threads;
  Result<Contacts> result = find_contacts(bodies, options);
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : to_string(result.error()));
  return result.ok() ? *result : Contacts{};
}

TubeForm round_tube(double radius) {
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

TEST(Overlaps, CrossingRoundYarns) {
  const yarn::Body a = straight("a", round_tube(0.5), Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 6.0);
  for (double degrees : {90.0, 45.0, 20.0})
    for (double distance : {0.799, 0.79, 0.75, 0.6, 0.3}) {
      const double angle = degrees * pi / 180.0;
      const yarn::Body b = straight("b", round_tube(0.3), {0.1, 0.2, distance},
                                    {std::cos(angle), std::sin(angle), 0}, {0, 0, 1}, 6.0);
      expect_overlap(a, b, 0.8 - distance,
                     (std::to_string(degrees) + " degrees at distance " + std::to_string(distance)).c_str());
    }
}

TEST(Overlaps, CrossingThroughTheMiddle) {
  const yarn::Body a = straight("a", round_tube(0.5), Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 6.0);
  for (double radius : {0.5, 0.3, 0.1}) {
    const yarn::Body b = straight("b", round_tube(radius), Vec3::Zero(), {0, 1, 0}, {0, 0, 1}, 6.0);
    expect_overlap(a, b, 0.5 + radius, std::to_string(radius).c_str());
  }
}

TEST(Overlaps, ParallelRoundYarns) {
  const yarn::Body a = straight("a", round_tube(0.5), Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 6.0);
  for (double distance : {0.799, 0.75, 0.5, 0.3}) {
    const Vec3 way = Vec3(0.0, 0.6, 0.8) * distance;
    const yarn::Body b = straight("b", round_tube(0.3), way + Vec3(0.7, 0, 0), {1, 0, 0}, {0, 0, 1}, 6.0);
    expect_overlap(a, b, 0.8 - distance, std::to_string(distance).c_str());
  }
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

TEST(Overlaps, YarnsThatAreTheSame) {
  // Straight and flat: apart across the thin direction.
  const yarn::Body a = straight("a", {0.4, 0.1, 64, 4}, Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 4.0);
  expect_overlap(a, a, 0.2, "equal");
  expect_overlap(a, moved(a, {0, 0, 1e-9}), 0.2, "nearly equal");
  expect_overlap(a, moved(a, {0.3, 0, 0.05}), 0.15, "shifted");
}

TEST(Overlaps, AYarnInsideAnother) {
  const yarn::Body thick = straight("thick", round_tube(0.5), Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 6.0);
  const yarn::Body thin = straight("thin", round_tube(0.1), {0, 0, 0.2}, {1, 0, 0}, {0, 1, 0}, 5.0);
  expect_overlap(thick, thin, 0.4, "inside");
}

// A prism along x, its outline (degree 1 round) in y and z, 6 long.
yarn::Body prism(const std::string& name, const std::vector<Vec2>& outline, const Vec3& middle) {
  yarn::GridNet net;
  net.sections = 4;
  net.degree_round = 1;
  net.per_section = static_cast<int>(outline.size());
  for (int j = 0; j < 4; ++j)
    for (const Vec2& p : outline) net.points.push_back(middle + Vec3(2.0 * j - 3.0, p.x(), p.y()));
  yarn::Body body;
  body.name = name;
  EXPECT_TRUE(yarn::fill_from_grid(body, net).ok());
  EXPECT_TRUE(yarn::finish(body, yarn::EndStyle::planar).ok());
  return body;
}

TEST(Overlaps, SharpEdges) {
  const std::vector<Vec2> square = {{1, -1}, {1, 1}, {-1, 1}, {-1, -1}},
                          diamond = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  const yarn::Body floor = prism("floor", square, Vec3::Zero());
  expect_overlap(floor, prism("square", square, {0.3, 0, 1.9}), 0.1, "face on face");
  expect_overlap(floor, prism("diamond", diamond, {0.3, 0.2, 1.9}), 0.1, "edge on face");
  const yarn::Body round_one = straight("round", round_tube(0.5), {0, 0, 1.46}, {0, 1, 0}, {1, 0, 0}, 6.0);
  expect_overlap(floor, round_one, 0.04, "cylinder across a face");
  expect_overlap(prism("edge", diamond, Vec3::Zero()), round_one, 0.04, "cylinder across an edge");
}

TEST(Overlaps, EndFaces) {
  const yarn::Body lying = straight("lying", round_tube(0.5), Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 6.0);
  const yarn::Body standing = straight("standing", round_tube(0.1), {0, 0, 2.3}, {0, 0, 1}, {1, 0, 0}, 4.0);
  expect_overlap(lying, standing, 0.2, "an end in a flank");
  expect_overlap(lying, moved(lying, {5.95, 0, 0}), 0.05, "end in end");
}

TEST(Overlaps, LinkedRings) {
  // Two rings that hook into each other without touching, then pulled until they share 0.05.
  const yarn::Body a = test::ring("a", 2.0, 0.3);
  yarn::Body b = a;
  for (nurbs::Surface* s : {&b.surface})
    for (Vec3& p : s->points) p = Vec3(p.x(), -p.z(), p.y());
  b.name = "b";
  // Inner sides at +-1.7: the hooks' inner sides meet when the middles are 3.4 apart.
  const Contacts apart = check({a, moved(b, {3.3, 0, 0})});
  EXPECT_TRUE(apart.list.empty());
  EXPECT_NEAR(apart.min_gap.value_or(-1.0), 0.1, 1e-3);
  const Contacts hooked = check({a, moved(b, {3.45, 0, 0})});
  ASSERT_EQ(hooked.list.size(), 1U);
  EXPECT_NEAR(hooked.list[0].depth(), 0.05, 5e-4);
  EXPECT_NEAR(hooked.list[0].at.x(), 1.725, 0.01);
}

TEST(Overlaps, WavesAcrossEachOtherNeedTheDirectionInWhichAllPlacesPart) {
  // One warp and one weft of a plain weave whose waves are too flat: the two part last in several places at a
  // time. No direction near the one that is given does with less.
  const auto wave = [](double sign, bool turned) {
    return test::tube("wave", {0.4, 0.1, 16, 16}, [=](double s, double u, double v) -> Vec3 {
      const double x = 2.0 * s, z = sign * 0.09 * std::sin(pi * x),
                   slope = sign * 0.09 * pi * std::cos(pi * x);
      const Vec3 p = Vec3(x, 0.5 + u, z) + v * Vec3(-slope, 0, 1).normalized();
      return turned ? Vec3(p.y(), p.x(), p.z()) : p;
    });
  };
  const yarn::Body a = wave(1.0, false), b = wave(-1.0, true);
  const Contacts result = check({a, b});
  ASSERT_EQ(result.list.size(), 1U);
  const Contact& overlap = result.list[0];
  EXPECT_TRUE(check({a, moved(b, 1.01 * overlap.depth() * overlap.direction)}).list.empty());
  const Vec3 x = overlap.direction.unitOrthogonal(), y = overlap.direction.cross(x);
  for (double tilt : {0.0, 0.03, 0.2})
    for (int k = 0; k < (tilt == 0.0 ? 1 : 6); ++k) {
      const double angle = k * pi / 3.0;
      const Vec3 n = (overlap.direction + tilt * (std::cos(angle) * x + std::sin(angle) * y)).normalized();
      EXPECT_FALSE(check({a, moved(b, 0.985 * overlap.depth() * n)}).list.empty()) << tilt << " " << k;
    }
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
  const yarn::Body a = straight("a", round_tube(0.5), Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 6.0);
  // The curve of a control circle touches its own tangents at the middles of the polygon's sides: exactly
  // 0.5.
  for (const Vec3& along : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, 1, 0)}) {
    const yarn::Body b = straight("b", round_tube(0.5), {0, 0, 1.0}, along, {0, 0, 1}, 6.0);
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

TEST(Gaps, BetweenStraightYarns) {
  const yarn::Body a = straight("a", round_tube(0.5), Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 6.0);
  for (double gap : {1e-4, 1e-3, 0.02, 0.3, 5.0}) {
    SCOPED_TRACE(gap);
    for (const Vec3& along : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, 2, 0)}) {
      const yarn::Body b = straight("b", round_tube(0.3), {0.1, 0, 0.8 + gap}, along, {0, 0, 1}, 6.0);
      const Contacts result = check({a, b});
      EXPECT_TRUE(result.list.empty());
      ASSERT_TRUE(result.min_gap.has_value());
      EXPECT_NEAR(*result.min_gap, gap, 0.01 * gap);
    }
  }
}

TEST(Gaps, TheLeastOfManyAndNoneOfOne) {
  std::vector<yarn::Body> bodies;
  double y = 0.0;
  for (int i = 0; i < 12; ++i) {
    bodies.push_back(straight("t", {0.5, 0.5, 32, 4}, {0, y, 0}, {1, 0, 0}, {0, 1, 0}, 6.0));
    y += 1.0 + (i == 7 ? 0.05 : 0.2 + 0.1 * i);
  }
  EXPECT_NEAR(check(bodies).min_gap.value_or(-1.0), 0.05, 5e-4);
  EXPECT_NEAR(check(bodies, 2).min_gap.value_or(-1.0), 0.05, 5e-4);
  EXPECT_FALSE(check({bodies[0]}).min_gap.has_value());
}

// Along itself a yarn is near itself everywhere, but it does not face itself unless it turned round.
TEST(Gaps, OfAYarnWithItselfHoweverFarOneLooks) {
  const auto near_itself = [](const yarn::Body& body, double reach) {
    ContactOptions options;
    options.reach = reach;
    const Result<Contacts> result = find_contacts({&body, 1}, options);
    EXPECT_TRUE(result.ok());
    return result.ok() ? result->list : std::vector<Contact>();
  };
  const yarn::Body line = straight("line", round_tube(0.5), Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 12.0);
  for (const double reach : {1.0, 3.0, 20.0}) EXPECT_TRUE(near_itself(line, reach).empty()) << reach;
  const std::vector<Contact> across = near_itself(test::ring("ring", 2.0, 0.5), 3.5);
  ASSERT_FALSE(across.empty());
  // 3 straight across; places that are not quite opposite face each other as well.
  EXPECT_GT(across.front().gap, 2.5);
  EXPECT_LT(across.front().gap, 3.03);
}

TEST(Gaps, ARingAroundAYarn) {
  const yarn::Body outer = test::ring("ring", 2.0, 0.5);
  const yarn::Body inner = straight("axis", round_tube(0.8), Vec3::Zero(), {0, 0, 1}, {1, 0, 0}, 4.0);
  const Contacts result = check({outer, inner});
  EXPECT_TRUE(result.list.empty());
  EXPECT_NEAR(result.min_gap.value_or(-1.0), 0.7, 0.007);
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
