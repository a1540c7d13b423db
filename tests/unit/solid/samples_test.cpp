// The samples, from their text to the verdict.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "built.h"
#include "formats/registry.h"
#include "places.h"
#include "solid/check.h"
#include "solid/tessellation.h"
#include "yarn/ends.h"

namespace selvage::solid {
namespace {

using yarn::EndStyle;

fabric::Fabric fabric_in(const std::string& sample) {
  Diagnostics diagnostics;
  Result<Source> source = Source::open(places::samples() + "/" + sample);
  std::optional<fabric::Fabric> fabric;
  if (source) fabric = formats::txt::descriptor().read_fabric(*source, diagnostics);
  EXPECT_TRUE(fabric.has_value()) << sample;
  return fabric.value_or(fabric::Fabric{});
}

std::vector<yarn::Body> bodies_of(const std::string& sample, EndStyle ends = EndStyle::patch) {
  fabric::BuildOptions options;
  options.ends = ends;
  return test::built(fabric_in(sample), options);
}

SolidCheck check(const std::vector<yarn::Body>& bodies) {
  Result<SolidCheck> result = check_solids(bodies, {});
  EXPECT_TRUE(result.ok());
  return result.ok() ? *result : SolidCheck{};
}

TEST(Samples, AreClosedSolids) {
  for (const auto& [sample, count] :
       {std::pair("plain4_grid.txt", 4U), std::pair("plain4_path.txt", 4U), std::pair("ring.txt", 1U)})
    for (EndStyle style : {EndStyle::patch, EndStyle::fan, EndStyle::planar}) {
      SCOPED_TRACE(std::string(sample) + " " + std::string(yarn::name_of(style)));
      const std::vector<yarn::Body> bodies = bodies_of(sample, style);
      ASSERT_EQ(bodies.size(), count);
      const SolidCheck result = check(bodies);
      for (std::size_t i = 0; i < bodies.size(); ++i) {
        const YarnCheck& yarn = result.yarns[i];
        EXPECT_TRUE(yarn.closed && yarn.bounds_volume && yarn.outward && !yarn.self_intersecting);
        for (const Message& m : yarn.defects) ADD_FAILURE() << to_string(m);
        // Triangles of a chord of a fiftieth of the section lie within it.
        EXPECT_NEAR(yarn.volume, bodies[i].volume, 0.02 * bodies[i].volume);
        EXPECT_LT(yarn.volume, bodies[i].volume);
        EXPECT_LE(yarn.end_gap, sewing_gap(bodies[i]));
      }
    }
}

// The grid has six decimals: its ends, flat to less than two units of the last one, are brought into their
// planes, and nothing else moves. Ends that leave a plane by more are sealed by none.
TEST(Samples, APlaneSealsEndsThatAreFlatToTheirDigits) {
  fabric::Fabric grid = fabric_in("plain4_grid.txt");
  fabric::BuildOptions options;
  const auto built = [&](EndStyle style) {
    options.ends = style;
    Diagnostics diagnostics;
    const auto builder = fabric::YarnBuilder::create(grid, options, diagnostics);
    return builder ? builder->build(0) : Result<yarn::Body>(Message());
  };
  const Result<yarn::Body> patch = built(EndStyle::patch), planar = built(EndStyle::planar);
  ASSERT_TRUE(patch.ok() && planar.ok());
  const std::vector<Vec3>&before = patch->surface.points, &after = planar->surface.points;
  ASSERT_EQ(before.size(), after.size());
  const auto round = static_cast<std::size_t>(planar->surface.count_u);
  double moved = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (i < round || i + round >= before.size())
      moved = std::max(moved, (before[i] - after[i]).norm());
    else
      EXPECT_EQ(before[i], after[i]);
  }
  EXPECT_NEAR(moved, 2.95e-7, 0.3e-7);
  for (const bool last : {false, true}) {
    const yarn::EndFace& end = last ? planar->end : planar->start;
    EXPECT_LT(yarn::flatness(yarn::end_curve(*planar, last), end.origin, end.normal), 1e-15);
  }

  std::get<fabric::Grid>(std::get<fabric::Yarn>(grid.items[0]).shape).points[3].x() += 1e-4;
  const Result<yarn::Body> bent = built(EndStyle::planar);
  ASSERT_FALSE(bent.ok());
  EXPECT_NE(bent.error().text.find("is not flat"), std::string::npos) << to_string(bent.error());
  options.tolerance = 1e-3;
  EXPECT_TRUE(built(EndStyle::planar).ok());
}

// A pressed section, concave, which no patch seals, tilted against all axes, given to six decimals: kidneys
// by x = cos t, y = 0.4 sin t - 0.5 cos^2 t, whose area is 0.4 pi.
TEST(Samples, ATiltedConcaveSectionOfSixDecimals) {
  const Vec3 along = Vec3(2, 1, 3).normalized(), across = Vec3(1, 1, -1).normalized(),
             up = along.cross(across);
  constexpr int round = 60, sections = 5;
  std::string text = "fabric 1\nthread t\n tex 100\n density 1.5\nend\nyarn kidney t\n grid 5 60\n";
  for (int s = 0; s < sections; ++s)
    for (int k = 0; k < round; ++k) {
      const double t = 2 * std::numbers::pi * k / round;
      const Vec3 p = (0.7 * s) * along + std::cos(t) * across +
                     (0.4 * std::sin(t) - 0.5 * std::cos(t) * std::cos(t)) * up;
      text += fmt::format("{:.6f} {:.6f} {:.6f}\n", p.x(), p.y(), p.z());
    }
  text += " end\nend\n";
  Diagnostics diagnostics;
  const auto fabric =
      formats::txt::descriptor().read_fabric(Source::from_memory(text, "kidney.txt"), diagnostics);
  ASSERT_TRUE(fabric);
  const std::vector<yarn::Body> bodies = test::built(*fabric, {});
  ASSERT_EQ(bodies.size(), 1U);
  EXPECT_EQ(bodies[0].start.style, EndStyle::planar);
  // The quadratic through the middles of the polygon's edges: a little inside of the kidney.
  EXPECT_NEAR(bodies[0].volume, 4 * 0.7 * 0.4 * std::numbers::pi, 0.01 * bodies[0].volume);
  const SolidCheck result = check(bodies);
  EXPECT_TRUE(result.yarns[0].closed);
  for (const Message& m : result.yarns[0].defects) ADD_FAILURE() << to_string(m);
}

TEST(Samples, TheSkinsVolumeGoesToTheBodys) {
  for (const char* sample : {"plain4_grid.txt", "plain4_path.txt", "ring.txt"}) {
    const std::vector<yarn::Body> bodies = bodies_of(sample);
    ASSERT_FALSE(bodies.empty());
    const yarn::Body& body = bodies.front();
    Result<Tessellation> skin = tessellate(body, yarn::narrowest_section(body) / 5000.0);
    ASSERT_TRUE(skin.ok());
    EXPECT_NEAR(volume(*skin), body.volume, 5e-4 * body.volume) << sample;
  }
}

TEST(Samples, AnEndFaceMovedByAMillionthOfAMillimetreIsFoundOpen) {
  for (const char* sample : {"plain4_grid.txt", "plain4_path.txt"}) {
    std::vector<yarn::Body> bodies = bodies_of(sample);
    ASSERT_EQ(bodies.size(), 4U);
    for (Vec3& p : bodies[2].start.surface.points) p.y() += 1e-6;
    const SolidCheck result = check(bodies);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(result.yarns[i].closed, i != 2);
    ASSERT_FALSE(result.yarns[2].defects.empty());
    EXPECT_EQ(result.yarns[2].defects[0].yarn, bodies[2].name);
    EXPECT_NE(result.yarns[2].defects[0].text.find("start"), std::string::npos);
  }
}

TEST(Samples, TheRingHasTheVolumeOfPappus) {
  const std::vector<yarn::Body> bodies = bodies_of("ring.txt");
  ASSERT_EQ(bodies.size(), 1U);
  const SolidCheck result = check(bodies);
  const double pappus = 2.0 * std::numbers::pi * 5.0 * std::numbers::pi * 0.25;
  EXPECT_NEAR(bodies[0].volume, pappus, 0.001 * pappus);
  EXPECT_NEAR(result.yarns[0].volume, pappus, 0.02 * pappus);
  EXPECT_FALSE(result.min_gap.has_value());
}

}  // namespace
}  // namespace selvage::solid
