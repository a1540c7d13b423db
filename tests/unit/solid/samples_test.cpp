// The samples, from their text to the verdict.
#include <gtest/gtest.h>

#include <numbers>

#include "built.h"
#include "formats/registry.h"
#include "places.h"
#include "solid/check.h"
#include "solid/tessellation.h"

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
      if (sample == std::string("plain4_grid.txt") && style == EndStyle::planar) continue;  // below
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

// The grid has six decimals: its ends are not flat enough for a plane.
TEST(Samples, APlaneSealsFlatEndsOnly) {
  const fabric::Fabric grid = fabric_in("plain4_grid.txt");
  fabric::BuildOptions options;
  options.ends = EndStyle::planar;
  Diagnostics diagnostics;
  const auto builder = fabric::YarnBuilder::create(grid, options, diagnostics);
  ASSERT_TRUE(builder);
  const Result<yarn::Body> body = builder->build(0);
  ASSERT_FALSE(body.ok());
  EXPECT_NE(body.error().text.find("is not flat"), std::string::npos) << to_string(body.error());
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
