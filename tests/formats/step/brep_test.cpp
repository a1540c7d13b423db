// OpenCASCADE's judgement on yarns, through the module as the program opens it.
#include "solid/brep.h"

#include <gtest/gtest.h>

#include "bodies.h"

namespace selvage {
namespace {

using solid::BrepCheck;
using yarn::EndStyle;

BrepCheck judge(const yarn::Body& body) {
  Result<std::vector<BrepCheck>> verdicts = solid::check_breps({&body, 1});
  EXPECT_TRUE(verdicts.ok()) << to_string(verdicts.error());
  return verdicts.ok() ? verdicts->front() : BrepCheck{};
}

std::string words(const BrepCheck& verdict) {
  std::string all;
  for (const Message& message : verdict.defects) all += to_string(message) + "\n";
  return all;
}

void expect_sound(const yarn::Body& body) {
  const BrepCheck verdict = judge(body);
  EXPECT_TRUE(verdict.valid) << body.name << "\n" << words(verdict);
  EXPECT_EQ(verdict.free_edges, 0);
  EXPECT_TRUE(verdict.defects.empty()) << words(verdict);
  EXPECT_NEAR(verdict.volume / body.volume, 1.0, 1e-6);
  EXPECT_LT(verdict.tolerance, 3e-7 * std::sqrt(body.end_area));
}

TEST(Brep, EveryEndStyleClosesTheYarn) {
  for (EndStyle style : {EndStyle::patch, EndStyle::fan, EndStyle::planar}) {
    expect_sound(tests::tube("tube_" + std::string(name_of(style)), style));
    expect_sound(tests::wave("wave_" + std::string(name_of(style)), style));
  }
}

TEST(Brep, SizeInTheFilesUnitDoesNotMatter) {
  for (double size : {1e-6, 1e-4, 1e-3, 39.37, 1e3, 1e6})
    for (EndStyle style : {EndStyle::patch, EndStyle::planar}) expect_sound(tests::wave("yarn", style, size));
}

TEST(Brep, FarFromTheOrigin) {
  for (EndStyle style : {EndStyle::patch, EndStyle::fan, EndStyle::planar})
    expect_sound(tests::wave("yarn", style, 1.0, {1e3, -2e3, 500}));
}

TEST(Brep, MirroredSectionsStillFaceOutward) {
  for (EndStyle style : {EndStyle::patch, EndStyle::fan, EndStyle::planar}) {
    const yarn::Body body =
        tests::grid_body("mirrored", style, 16, 6, false, [](double round, double along) -> Vec3 {
          const Vec3 p = tests::turn(-round);
          return {0.8 * p.x(), 0.5 * p.y(), 5.0 * along};
        });
    EXPECT_TRUE(body.inward);
    expect_sound(body);
  }
}

TEST(Brep, WeightsMakeItRational) {
  yarn::Body body;
  body.name = "rational";
  yarn::GridNet net;
  net.sections = 6;
  net.per_section = 12;
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < 12; ++i) {
      const Vec3 p = tests::turn((i + 0.5) / 12);
      net.points.emplace_back(0.8 * p.x(), 0.5 * p.y(), j);
      net.weights.push_back(1.0 + 0.5 * ((i + j) % 3));
    }
  for (EndStyle style : {EndStyle::patch, EndStyle::fan, EndStyle::planar}) {
    ASSERT_TRUE(yarn::fill_from_grid(body, net).ok());
    ASSERT_TRUE(yarn::finish(body, style).ok());
    ASSERT_TRUE(body.surface.is_rational());
    expect_sound(body);
  }
}

TEST(Brep, RingHasPappusVolume) {
  const double diameter = 1.0, radius = 5.0;
  const yarn::Body body = tests::ring("ring", diameter, radius);
  expect_sound(body);
  const double pappus = std::numbers::pi / 4 * diameter * diameter * 2 * std::numbers::pi * radius;
  // What 48 parabolas lack of a circle: between the tangent polygon, which they touch at its sides' middles,
  // and it.
  EXPECT_NEAR(judge(body).volume / pappus, 1.0, 1e-4);
}

TEST(Brep, OpenEndsAreNoSolid) {
  const BrepCheck verdict = judge(tests::tube("sleeve", EndStyle::none));
  EXPECT_FALSE(verdict.valid);
  EXPECT_EQ(verdict.free_edges, 2);
  EXPECT_NE(words(verdict).find("sleeve"), std::string::npos);
}

TEST(Brep, MovedEndIsFoundNotHealed) {
  for (EndStyle style : {EndStyle::patch, EndStyle::fan, EndStyle::planar}) {
    yarn::Body body = tests::wave("moved", style);
    const Vec3 shift = 1e-6 * body.end.normal;
    for (Vec3& p : body.end.surface.points) p += shift;
    body.end.origin += shift;
    const BrepCheck verdict = judge(body);
    EXPECT_FALSE(verdict.valid) << name_of(style);
    EXPECT_GT(verdict.free_edges, 0) << name_of(style);
    ASSERT_FALSE(verdict.defects.empty());
    EXPECT_EQ(verdict.defects.front().yarn, "moved");
    ASSERT_TRUE(verdict.defects.front().at.has_value());
    EXPECT_LT((*verdict.defects.front().at - body.end.origin).norm(), 1e-9);
    EXPECT_NE(words(verdict).find("1e-06"), std::string::npos) << words(verdict);
  }
}

TEST(Brep, WrongOrientationIsFound) {
  yarn::Body body = tests::tube("turned", EndStyle::patch);
  body.end.inward = !body.end.inward;
  EXPECT_FALSE(judge(body).valid);
  body = tests::ring("inside_out", 1.0, 5.0);
  body.inward = !body.inward;
  const BrepCheck verdict = judge(body);
  EXPECT_FALSE(verdict.valid);
  EXPECT_LT(verdict.volume, 0);
}

TEST(Brep, WhatCannotBeBuiltIsADefectOfThatYarn) {
  std::vector<yarn::Body> bodies = {tests::tube("good", EndStyle::patch),
                                    tests::tube("bad", EndStyle::patch)};
  bodies[1].surface.knots_u.pop_back();
  Result<std::vector<BrepCheck>> verdicts = solid::check_breps(bodies);
  ASSERT_TRUE(verdicts.ok());
  EXPECT_TRUE((*verdicts)[0].valid);
  EXPECT_FALSE((*verdicts)[1].valid);
  EXPECT_NE(words((*verdicts)[1]).find("bad"), std::string::npos);
}

}  // namespace
}  // namespace selvage
