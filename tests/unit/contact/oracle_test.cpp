// Detection on random pairs of tubes against an oracle that shares nothing with it but the evaluation of
// surfaces.
#include <gtest/gtest.h>

#include <random>

#include "contact/contact.h"
#include "unit/contact/oracle.h"
#include "unit/solid/bodies.h"

namespace selvage::contact {
namespace {

using test::moved;

using std::numbers::pi;

enum class Section { round, elliptic, lenticular };

// A tube 8 long through the origin, straight or bent on an arc in its own xz plane (upward or downward),
// turned about x and then about z.
struct Tube {
  Section section = Section::round;
  double half_width = 0.5, half_height = 0.5;
  double bend = 0;  // curvature
  double roll = 0, heading = 0;

  [[nodiscard]] yarn::Body build(const std::string& name) const {
    const test::TubeForm form{1.0, 1.0, 32, bend == 0.0 ? 6 : 24};
    const Eigen::AngleAxisd turn(heading, Vec3::UnitZ());
    return test::tube(name, form, [&](double along, double x, double y) -> Vec3 {
      const Vec2 p = outline(x, y);
      const Vec2 rolled(p.x() * std::cos(roll) - p.y() * std::sin(roll),
                        p.x() * std::sin(roll) + p.y() * std::cos(roll));
      const double way = 8.0 * (along - 0.5);
      if (bend == 0.0) return turn * Vec3(way, rolled.x(), rolled.y());
      const double angle = way * bend;
      const Vec3 centre(std::sin(angle) / bend, 0, (1.0 - std::cos(angle)) / bend);
      return turn *
             (centre + rolled.x() * Vec3::UnitY() + rolled.y() * Vec3(-std::sin(angle), 0, std::cos(angle)));
    });
  }

 private:
  [[nodiscard]] Vec2 outline(double x, double y) const {
    if (section != Section::lenticular) return {half_width * x, half_height * y};
    // Two arcs, nearly: a parabola over the width on either side.
    const double across = std::clamp(x, -1.0, 1.0);
    return {half_width * x, half_height * (y < 0 ? -1.0 : 1.0) * (1.0 - across * across)};
  }
};

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random() % 1000003) / 1000003.0);
}

Tube random_tube(std::mt19937& random) {
  Tube tube;
  tube.section = static_cast<Section>(random() % 3);
  tube.half_height = uniform(random, 0.15, 0.5);
  tube.half_width =
      tube.section == Section::round ? tube.half_height : tube.half_height * uniform(random, 1.5, 3.0);
  if (random() % 2 == 0) tube.bend = uniform(random, -0.06, 0.06);
  if (random() % 3 == 0 && tube.section != Section::lenticular) tube.roll = uniform(random, -0.4, 0.4);
  return tube;
}

// Bends are wide and angles large enough that tips and ends stay apart: there the least distance is at no
// critical pair, and the oracle sees none.
//
// The second tube is set down on the first one, and moved along their common normal to the wanted gap: that
// pair of points keeps its normals.
TEST(Oracle, TwoHundredPairsOfTubes) {
  std::mt19937 random(20261121);
  const std::vector<double> gaps = {-0.2, -0.05, -1e-2, -1e-3, -1e-4, -3e-6,
                                    3e-6, 1e-4,  1e-3,  1e-2,  0.1,   0.5};
  int overlapping = 0, apart = 0, measured = 0;
  for (int k = 0; k < 200; ++k) {
    SCOPED_TRACE(k);
    Tube first = random_tube(random), second = random_tube(random);
    second.heading = uniform(random, 0.6, 0.5 * pi) * (random() % 2 == 0 ? 1.0 : -1.0);
    const double thickness = 2.0 * std::min(first.half_height, second.half_height);
    const yarn::Body a = first.build("a");
    const yarn::Body b =
        moved(second.build("b"), {uniform(random, -0.5, 0.5), uniform(random, -0.5, 0.5), 2.5});
    const std::optional<test::FacingPair> start = test::sampled_deepest(a, b, 4.0, 40, 80);
    if (!start) continue;
    const double wanted = gaps[static_cast<std::size_t>(k) % gaps.size()] * thickness;
    const yarn::Body there = moved(b, (start->depth + wanted) * start->normal);
    const std::optional<test::FacingPair> deepest = test::sampled_deepest(a, there, 0.6 * thickness, 48, 96);
    if (!deepest) continue;
    ++measured;
    ContactOptions options;
    options.reach = thickness;
    const Result<Contacts> found = find_contacts(std::vector{a, there}, options);
    ASSERT_TRUE(found.ok());
    EXPECT_LE(found->resolution, 1.001e-6 * thickness);
    ASSERT_FALSE(found->list.empty());
    const Contact& worst = found->list.front();
    if (deepest->depth > 1e-6 * thickness) {
      ++overlapping;
      ASSERT_TRUE(worst.is_overlap()) << deepest->depth / thickness;
      // The least translation is the deepest spot's own depth, or more where there are several.
      EXPECT_NEAR(-worst.spots.front().gap, deepest->depth, 0.01 * deepest->depth);
      EXPECT_GE(worst.depth(), 0.99 * deepest->depth);
    } else if (deepest->depth < -1e-6 * thickness) {
      ++apart;
      EXPECT_FALSE(worst.is_overlap()) << worst.gap / thickness << " for " << deepest->depth / thickness;
      EXPECT_NEAR(worst.gap, -deepest->depth, 0.01 * -deepest->depth);
      EXPECT_NEAR(found->min_gap.value_or(-1.0), -deepest->depth, 0.01 * -deepest->depth);
    }
    // Tessellations tell overlaps and gaps beyond their chord errors.
    const double chord = thickness / 200.0;
    if (k % 4 == 0 && std::abs(deepest->depth) > 2.5 * chord) {
      EXPECT_EQ(test::common_volume(a, there, chord) > 0.0, worst.is_overlap());
    }
  }
  EXPECT_GE(measured, 195);
  EXPECT_GE(overlapping, 90);
  EXPECT_GE(apart, 80);
}

}  // namespace
}  // namespace selvage::contact
