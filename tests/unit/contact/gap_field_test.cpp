// Gaps at the vertices of skins against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "contact/contact.h"
#include "solid/gap_map.h"
#include "unit/solid/bodies.h"

namespace selvage::contact {
namespace {

using test::straight;
using test::TubeForm;

using std::numbers::pi;

TubeForm round(double radius) {
  return {radius, radius, 64, 4};
}

solid::GapMap map_of(const std::vector<yarn::Body>& bodies, double reach, int threads = 2) {
  solid::GapMapOptions options;
  options.reach = reach;
  options.threads = threads;
  Result<solid::GapMap> map = solid::gap_map(bodies, options);
  EXPECT_TRUE(map.ok()) << (map.ok() ? "" : to_string(map.error()));
  return map.ok() ? *map : solid::GapMap{};
}

double least(const std::vector<double>& values) {
  return *std::min_element(values.begin(), values.end());
}

double from_axis(const Vec3& point, const Vec3& on_axis, const Vec3& along) {
  return (point - on_axis).cross(along.normalized()).norm();
}

// A round yarn along x and one across it above, at an angle, far from each other's ends.
TEST(GapField, CrossingRoundYarns) {
  constexpr double r = 0.5, s = 0.3, reach = 0.25;
  for (double degrees : {90.0, 35.0})
    for (double distance : {1.0, 0.85, 0.75, 0.6, 0.2, 0.0}) {
      SCOPED_TRACE(std::to_string(degrees) + " degrees, distance " + std::to_string(distance));
      const Vec3 along(std::cos(degrees * pi / 180), std::sin(degrees * pi / 180), 0), above(0, 0, distance);
      const std::vector<yarn::Body> bodies = {
          straight("a", round(r), Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), 8.0),
          straight("b", round(s), above, along, Vec3::UnitZ(), 8.0)};
      const solid::GapMap map = map_of(bodies, reach);
      ASSERT_EQ(map.gaps.size(), 2U);
      double lowest = reach;
      for (std::size_t k = 0; k < 2; ++k) {
        ASSERT_EQ(map.gaps[k].size(), map.skins[k].vertices.size());
        const double radius = k == 0 ? s : r;  // of the other one
        for (std::size_t v = 0; v < map.gaps[k].size(); ++v) {
          const Vec3& p = map.skins[k].vertices[v];
          const double exact =
              k == 0 ? from_axis(p, above, along) - s : from_axis(p, Vec3::Zero(), Vec3::UnitX()) - r;
          // The other skin is at most a chord (1/100 of its thickness) inside its surface.
          EXPECT_GE(map.gaps[k][v], std::min(reach, exact) - 1e-5);
          EXPECT_LE(map.gaps[k][v], std::min(reach, exact + 0.02 * radius) + 1e-5);
          lowest = std::min(lowest, map.gaps[k][v]);
        }
      }
      // The deepest point is a vertex to within the chords, while no yarn passes the other one's middle.
      if (distance >= s) {
        EXPECT_NEAR(lowest, std::min(reach, distance - r - s), 0.02 * (r + s));
      }
      EXPECT_EQ(lowest < 0.0, distance < r + s);
    }
}

TEST(GapField, OneInsideAnother) {
  const std::vector<yarn::Body> bodies = {
      straight("a", round(0.5), Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), 6.0),
      straight("b", round(0.2), Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), 4.0)};
  const solid::GapMap map = map_of(bodies, 0.05);
  for (std::size_t v = 0; v < map.gaps[1].size(); ++v) {
    const Vec3& p = map.skins[1].vertices[v];
    EXPECT_NEAR(map.gaps[1][v], from_axis(p, Vec3::Zero(), Vec3::UnitX()) - 0.5, 0.011);
  }
  EXPECT_DOUBLE_EQ(least(map.gaps[0]), 0.05);  // nothing is in or near the outer one's skin
}

// The deepest value is the depth that the exact search finds.
TEST(GapField, AgreesWithTheContacts) {
  for (double turn : {0.0, 0.4, 1.1}) {
    const std::vector<yarn::Body> bodies = {
        straight("a", {0.6, 0.2, 64, 4}, Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), 6.0),
        straight("b", {0.5, 0.25, 64, 4}, {0.3, 0.1, 0.37}, {turn, 1, 0}, {1, -turn, 0.3}, 6.0)};
    const Result<Contacts> contacts = find_contacts(bodies, {});
    ASSERT_TRUE(contacts.ok());
    ASSERT_FALSE(contacts->list.empty());
    const solid::GapMap map = map_of(bodies, 0.1);
    EXPECT_NEAR(std::min(least(map.gaps[0]), least(map.gaps[1])), contacts->list.front().gap, 0.01 * 0.4);
  }
}

// Two legs along x, joined by a half circle of this radius.
yarn::Body hairpin(double radius, double thickness) {
  const double legs = 3.0, bend = pi * radius, length = 2.0 * legs + bend;
  TubeForm form = round(0.5 * thickness);
  form.sections = 200;
  return test::tube("hairpin", form, [=](double share, double x, double y) -> Vec3 {
    const double s = share * length;
    if (s < legs) return {s - legs, -radius - x, y};
    if (s > legs + bend) return {length - s - legs, radius + x, y};
    const double angle = (s - legs) / radius - 0.5 * pi;
    return {(radius + x) * std::cos(angle), (radius + x) * std::sin(angle), y};
  });
}

TEST(GapField, AYarnNearItself) {
  for (double gap : {0.3, 0.05, -0.1}) {
    SCOPED_TRACE(gap);
    const double thickness = 1.0, radius = 0.5 * (thickness + gap);
    const std::vector<yarn::Body> bodies = {hairpin(radius, thickness)};
    const solid::GapMap map = map_of(bodies, 0.5);
    std::size_t seen = 0;
    for (std::size_t v = 0; v < map.gaps[0].size(); ++v) {
      const Vec3& p = map.skins[0].vertices[v];
      if (p.x() > -2.0 || p.x() < -2.8) continue;  // the legs, away from bend and ends
      const Vec3 other(0, p.y() < 0 ? radius : -radius, 0);
      // The nearer leg is the own one where the vertex is far out; where legs overlap a vertex may be past
      // the middle.
      if (std::abs(std::abs(p.y()) - radius) > 0.5 * thickness + 1e-3) continue;
      const double to_other = from_axis(p, other, Vec3::UnitX()) - 0.5 * thickness;
      const double to_same = from_axis(p, -other, Vec3::UnitX()) - 0.5 * thickness;
      const double exact = std::abs(to_same) < 1e-3 ? to_other : to_same;
      EXPECT_NEAR(map.gaps[0][v], std::min(0.5, exact), 0.011) << p.transpose();
      ++seen;
    }
    EXPECT_GT(seen, 100U);
  }
}

// However far one looks, a straight yarn does not meet itself, not even at 1.5 widths.
TEST(GapField, NoYarnIsNearItsOwnSides) {
  const std::vector<yarn::Body> bodies = {
      straight("a", round(0.5), Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), 12.0)};
  EXPECT_DOUBLE_EQ(least(map_of(bodies, 4.0).gaps[0]), 4.0);
}

// Behind an open end is outside, although the rim's side turns its back there.
TEST(GapField, OpenEnds) {
  TubeForm open = round(0.5);
  open.ends = yarn::EndStyle::none;
  const std::vector<yarn::Body> bodies = {
      straight("a", open, Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), 4.0),
      straight("b", round(0.1), {2.2, 0, 0}, Vec3::UnitZ(), Vec3::UnitY(), 4.0)};
  const solid::GapMap map = map_of(bodies, 0.3);
  EXPECT_GT(least(map.gaps[1]), 0.05);
  EXPECT_LT(least(map.gaps[1]), 0.15);  // the rim passes it at 0.1
}

TEST(GapField, AnyNumberOfThreads) {
  const std::vector<yarn::Body> bodies = {
      hairpin(0.6, 1.0), straight("b", round(0.3), {-1, 0, 0.7}, Vec3::UnitY(), Vec3::UnitX(), 4.0)};
  EXPECT_EQ(map_of(bodies, 0.2, 1).gaps, map_of(bodies, 0.2, 4).gaps);
}

TEST(GapField, NoYarns) {
  EXPECT_TRUE(map_of({}, 0.0).gaps.empty());
}

}  // namespace
}  // namespace selvage::contact
