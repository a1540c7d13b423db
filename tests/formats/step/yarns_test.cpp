// STEP files of yarns as our own writer has them: what they say of themselves, computed anew from what is
// read.
#include <gtest/gtest.h>

#include <cstdlib>
#include <numbers>
#include <regex>

#include "bodies.h"
#include "formats/registry.h"
#include "nurbs/measure.h"

namespace selvage {
namespace {

using yarn::EndStyle;

std::string written_yarns(const std::vector<yarn::Body>& bodies,
                          const formats::SurfaceOptions& options = {}) {
  Result<OutputFile> output = OutputFile::in_memory();
  if (!output) return to_string(output.error());
  auto writer = formats::step::descriptor().open_bodies(*output, options);
  if (!writer) return to_string(writer.error());
  for (const yarn::Body& body : bodies)
    if (Status added = (*writer)->add(body); !added.ok()) return to_string(added.error());
  if (auto facts = (*writer)->finish(); !facts) return to_string(facts.error());
  const Result<std::string> text = output->contents();
  return text ? *text : to_string(text.error());
}

// The values of all measures of a type, in file order.
std::vector<double> measures(std::string text, const std::string& type) {
  std::erase(text, '\n');
  std::vector<double> values;
  const std::regex measure(type + R"(\(([^)]*)\))");
  for (std::sregex_iterator it(text.begin(), text.end(), measure), none; it != none; ++it)
    values.push_back(std::stod((*it)[1]));
  return values;
}

std::vector<Vec3> centres(std::string text) {
  std::erase(text, '\n');
  std::vector<Vec3> places;
  const std::regex centre(R"(CARTESIAN_POINT\('centre point',\(([^,]*),([^,]*),([^)]*)\)\))");
  for (std::sregex_iterator it(text.begin(), text.end(), centre), none; it != none; ++it)
    places.emplace_back(std::stod((*it)[1]), std::stod((*it)[2]), std::stod((*it)[3]));
  return places;
}

TEST(StepYarns, SayTheirVolumes) {
  for (const EndStyle style : {EndStyle::patch, EndStyle::fan, EndStyle::planar}) {
    const std::vector<yarn::Body> bodies = {tests::wave("wave", style),
                                            tests::tube("tube", style, 2.0, {3, 4, 5})};
    const std::string text = written_yarns(bodies);
    const std::vector<double> volumes = measures(text, "VOLUME_MEASURE");
    ASSERT_EQ(volumes.size(), 3U) << text.substr(0, 300);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(volumes[i] / bodies[i].volume, 1.0, 1e-12);
    EXPECT_NEAR(volumes[2], volumes[0] + volumes[1], 1e-12);
    const std::vector<Vec3> places = centres(text);
    ASSERT_EQ(places.size(), 3U);
    EXPECT_LT((places[0] - Vec3(0, 2, 0)).cwiseAbs().x(), 1e-12);
    // The control polygon of 16 even points has its middle in its axis.
    EXPECT_LT((places[1] - Vec3(3, 4, 10)).norm(), 1e-11);
    EXPECT_LT((places[2] - (volumes[0] * places[0] + volumes[1] * places[1]) / volumes[2]).norm(), 1e-11);
  }
}

// Pappus: 4 pi^2 R r and 2 pi^2 R r^2, as near as the B-spline is to the torus.
TEST(StepYarns, ARingHasThePappusArea) {
  const std::string text = written_yarns({tests::ring("ring", 1.0, 5.0)});
  const double square = std::numbers::pi * std::numbers::pi;
  const std::vector<double> areas = measures(text, "AREA_MEASURE"),
                            volumes = measures(text, "VOLUME_MEASURE");
  ASSERT_EQ(areas.size(), 2U) << text.substr(0, 300);
  EXPECT_NEAR(areas[0] / (4 * square * 5 * 0.5), 1.0, 2e-3);
  EXPECT_NEAR(volumes[0] / (2 * square * 5 * 0.25), 1.0, 2e-3);
  EXPECT_LT(centres(text).at(0).norm(), 1e-11);
}

TEST(StepYarns, AnOpenYarnHasAnAreaOnly) {
  const std::string text = written_yarns({tests::tube("sleeve", EndStyle::none)});
  EXPECT_EQ(measures(text, "AREA_MEASURE").size(), 2U) << text.substr(0, 300);
  EXPECT_TRUE(measures(text, "VOLUME_MEASURE").empty());
  EXPECT_NE(text.find("SHELL_BASED_SURFACE_MODEL('sleeve'"), std::string::npos);
}

// Each after the other, and each in a file of its own.
TEST(StepYarns, CopiesMeasureAsTheyDoAlone) {
  const yarn::Body first = tests::wave("first", EndStyle::patch);
  const Eigen::AngleAxisd turn(0.7, Vec3(1, 2, 3).normalized());
  const auto moved = [&](const Vec3& p) { return Vec3(turn * p + Vec3(30, -20, 10)); };
  yarn::Body copy = first, other = tests::wave("other", EndStyle::patch, 1.001);
  copy.name = "copy";
  for (nurbs::Surface* surface : {&copy.surface, &copy.start.surface, &copy.end.surface})
    for (Vec3& p : surface->points) p = moved(p);
  const std::string text = written_yarns({first, copy, other});
  const std::vector<double> volumes = measures(text, "VOLUME_MEASURE"),
                            areas = measures(text, "AREA_MEASURE");
  ASSERT_EQ(volumes.size(), 4U) << text.substr(0, 300);
  std::size_t i = 0;
  for (const yarn::Body* const body : std::initializer_list<const yarn::Body*>{&first, &copy, &other}) {
    const std::string alone = written_yarns({*body});
    EXPECT_NEAR(volumes[i] / measures(alone, "VOLUME_MEASURE").at(0), 1.0, 1e-12) << body->name;
    EXPECT_NEAR(areas[i] / measures(alone, "AREA_MEASURE").at(0), 1.0, 1e-12) << body->name;
    EXPECT_LT((centres(text).at(i) - centres(alone).at(0)).norm(), 1e-12) << body->name;
    ++i;
  }
  EXPECT_LT((centres(text)[1] - moved(centres(text)[0])).norm(), 1e-12);
  EXPECT_GT(volumes[2] / volumes[0], 1.002);
}

TEST(StepYarns, APlaneEndThatCrossesItselfIsRefused) {
  // A section with two lobes, one smaller than the other, run round in opposite directions.
  const auto eight = [](double waist) {
    return tests::grid_body("eight", EndStyle::planar, 24, 6, false, [&](double round, double along) -> Vec3 {
      const double angle = 2 * std::numbers::pi * round, x = std::cos(angle);
      return {x + 0.3 * x * x, waist * std::sin(2 * angle) * (1.2 + x) + (1 - waist) * std::sin(angle),
              5 * along};
    });
  };
  const std::string crossing = written_yarns({eight(1.0)}), round = written_yarns({eight(0.1)});
  EXPECT_NE(crossing.find("yarn 'eight': the outline at its start crosses itself"), std::string::npos)
      << crossing.substr(0, 300);
  EXPECT_TRUE(round.starts_with("ISO-10303-21;")) << round.substr(0, 300);
}

// The paraboloid z = (x^2 + y^2) / 2 over the unit square: its area is known in closed form.
TEST(StepYarns, AParaboloidHasItsArea) {
  nurbs::Surface bowl;
  bowl.degree_u = bowl.degree_v = 2;
  bowl.count_u = bowl.count_v = 3;
  bowl.knots_u = bowl.knots_v = {0, 0, 0, 1, 1, 1};
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      bowl.points.emplace_back(0.5 * i, 0.5 * j, (i == 2 ? 0.5 : 0) + (j == 2 ? 0.5 : 0));
  // Inner integral by hand, the outer one by Simpson's rule on 2000 steps.
  const auto inner = [](double x) {
    const double a = 1 + x * x, root = std::sqrt(a + 1);
    return 0.5 * (root + a * std::asinh(1 / std::sqrt(a)));
  };
  double area = 0;
  const int steps = 2000;
  for (int k = 0; k <= steps; ++k)
    area += inner(1.0 * k / steps) * (k == 0 || k == steps ? 1 : k % 2 == 1 ? 4 : 2) / (3.0 * steps);
  const nurbs::Moments moments = nurbs::moments(bowl, Vec3::Zero());
  EXPECT_NEAR(moments.area, area, 2e-10);
  EXPECT_LT((moments.area_vector - Vec3(-0.5, -0.5, 1)).norm(), 1e-14);
  // (x, y, z) . (-x, -y, 1) = -z, whose integral is 1/3.
  EXPECT_NEAR(moments.volume, -1.0 / 9, 1e-15);
}

TEST(StepYarns, ADiskOfTheUnitCircleHasItsMoments) {
  // A rational quarter turn after the other: exact.
  nurbs::Surface disc;
  disc.degree_u = 2;
  disc.degree_v = 1;
  disc.count_u = 9;
  disc.count_v = 2;
  disc.knots_u = {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4};
  disc.knots_v = {0, 0, 1, 1};
  const Vec3 at(1, 2, 3);
  for (const double radius : {0.0, 1.0})
    for (int i = 0; i < 9; ++i) {
      const double angle = std::numbers::pi / 4 * i,
                   reach = i % 2 == 0 ? radius : radius * std::numbers::sqrt2;
      disc.points.push_back(at + reach * Vec3(std::cos(angle), std::sin(angle), 0));
      disc.weights.push_back(i % 2 == 0 ? 1.0 : std::numbers::sqrt2 / 2);
    }
  const nurbs::Moments moments = nurbs::moments(disc, Vec3::Zero());
  EXPECT_NEAR(moments.area, std::numbers::pi, 1e-9);
  EXPECT_LT((moments.area_vector.cwiseAbs() - Vec3(0, 0, std::numbers::pi)).norm(), 1e-12);
  EXPECT_NEAR(std::abs(moments.volume), std::numbers::pi, 1e-12);  // of a cone to the origin
  EXPECT_LT((moments.first / moments.volume - 0.75 * at).norm(), 1e-12);
}

}  // namespace
}  // namespace selvage
