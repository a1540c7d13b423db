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

std::string written(const std::vector<yarn::Body>& bodies, const formats::SurfaceOptions& options = {}) {
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
    const std::string text = written(bodies);
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
  const std::string text = written({tests::ring("ring", 1.0, 5.0)});
  const double square = std::numbers::pi * std::numbers::pi;
  const std::vector<double> areas = measures(text, "AREA_MEASURE"),
                            volumes = measures(text, "VOLUME_MEASURE");
  ASSERT_EQ(areas.size(), 2U) << text.substr(0, 300);
  EXPECT_NEAR(areas[0] / (4 * square * 5 * 0.5), 1.0, 2e-3);
  EXPECT_NEAR(volumes[0] / (2 * square * 5 * 0.25), 1.0, 2e-3);
  EXPECT_LT(centres(text).at(0).norm(), 1e-11);
}

TEST(StepYarns, AnOpenYarnHasAnAreaOnly) {
  const std::string text = written({tests::tube("sleeve", EndStyle::none)});
  EXPECT_EQ(measures(text, "AREA_MEASURE").size(), 2U) << text.substr(0, 300);
  EXPECT_TRUE(measures(text, "VOLUME_MEASURE").empty());
  EXPECT_NE(text.find("SHELL_BASED_SURFACE_MODEL('sleeve'"), std::string::npos);
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
