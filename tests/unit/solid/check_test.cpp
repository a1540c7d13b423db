// The CGAL module on yarns whose faults are known.
#include "solid/check.h"

#include <gtest/gtest.h>

#include <numbers>

#include "unit/solid/bodies.h"

namespace selvage::solid {
namespace {

using test::straight;
using test::TubeForm;
using yarn::EndStyle;

using std::numbers::pi;

YarnCheck check_one(const yarn::Body& body, double chord = 0.0) {
  CheckOptions options;
  options.chord = chord;
  Result<SolidCheck> result = check_solids({&body, 1}, options);
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : to_string(result.error()));
  return result.ok() ? result->yarns.at(0) : YarnCheck{};
}

void expect_valid(const YarnCheck& check) {
  EXPECT_TRUE(check.closed);
  EXPECT_FALSE(check.self_intersecting);
  EXPECT_TRUE(check.bounds_volume);
  EXPECT_TRUE(check.outward);
  for (const Message& m : check.defects) ADD_FAILURE() << to_string(m);
}

bool has_defect(const YarnCheck& check, std::string_view words) {
  for (const Message& m : check.defects)
    if (m.text.find(words) != std::string::npos) return true;
  return false;
}

// A tube bent to an arc of the given radius over three quarters of a circle.
yarn::Body arc(double radius, double section) {
  return test::tube("arc", {section, section, 16, 24}, [=](double s, double u, double v) -> Vec3 {
    const double phi = 1.5 * pi * s;
    return {(radius + u) * std::cos(phi), (radius + u) * std::sin(phi), v};
  });
}

TEST(Check, EveryEndStyleIsAClosedSolid) {
  for (EndStyle style : {EndStyle::patch, EndStyle::fan, EndStyle::planar}) {
    SCOPED_TRACE(std::string(yarn::name_of(style)));
    const yarn::Body body =
        straight("tube", {0.4, 0.1, 32, 4, false, style}, {10, 2, 3}, {1, 0.3, -0.2}, {0, 0, 1}, 5.0);
    const YarnCheck check = check_one(body, 1e-4);
    expect_valid(check);
    EXPECT_NEAR(check.volume, pi * 0.4 * 0.1 * 5.0, 1e-3 * check.volume);
    EXPECT_LT(check.end_gap, 1e-13);
  }
}

TEST(Check, RingAndArcAreValid) {
  const YarnCheck ring = check_one(test::ring("ring", 5.0, 0.5), 1e-4);
  expect_valid(ring);
  EXPECT_NEAR(ring.volume, 2.0 * pi * 5.0 * pi * 0.25, 2e-3 * ring.volume);
  expect_valid(check_one(arc(2.0, 0.5)));
}

TEST(Check, OpenEndsAreADefect) {
  const YarnCheck check = check_one(
      straight("open", {1, 1, 16, 4, false, EndStyle::none}, Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 4.0));
  EXPECT_FALSE(check.closed);
  EXPECT_FALSE(check.bounds_volume);
  EXPECT_TRUE(has_defect(check, "no face at its start"));
  EXPECT_TRUE(has_defect(check, "no face at its end"));
}

TEST(Check, AnEndFaceMovedByAMillionthIsFoundOpen) {
  for (EndStyle style : {EndStyle::patch, EndStyle::fan, EndStyle::planar})
    for (const Vec3& move : {Vec3(1e-6, 0, 0), Vec3(0, 1e-6, 0)}) {
      SCOPED_TRACE(std::string(yarn::name_of(style)));
      yarn::Body body =
          straight("tow", {0.4, 0.1, 16, 16, false, style}, {1, 0.5, 0}, {1, 0, 0}, {0, 1, 0}, 2.0);
      if (style == EndStyle::planar && move.x() == 0.0)
        continue;  // a plane moved in itself is the same plane
      for (Vec3& p : body.end.surface.points) p += move;
      body.end.origin += move;
      const YarnCheck check = check_one(body);
      EXPECT_FALSE(check.closed);
      EXPECT_FALSE(check.bounds_volume);
      EXPECT_TRUE(has_defect(check, "open: the edge of the end face of yarn 'tow' is 1e-06 away"));
      EXPECT_NEAR(check.end_gap, 1e-6, 1e-12);
      ASSERT_FALSE(check.defects.empty());
      EXPECT_EQ(check.defects[0].yarn, "tow");
      EXPECT_TRUE(check.defects[0].at.has_value());
    }
}

TEST(Check, ATubeBentTighterThanItsSectionCrossesItself) {
  const YarnCheck check = check_one(arc(0.6, 1.0));
  EXPECT_TRUE(check.self_intersecting);
  EXPECT_FALSE(check.bounds_volume);
  EXPECT_TRUE(has_defect(check, "crosses itself"));
  ASSERT_TRUE(check.self_intersection_at.has_value());
  EXPECT_LT(check.self_intersection_at->norm(), 1.7);  // inside the arc's outer radius
}

TEST(Check, AFigureEightCrossesItselfAtItsMiddle) {
  const yarn::Body body =
      test::tube("eight", {0.2, 0.2, 12, 40, true}, [](double s, double u, double v) -> Vec3 {
        const double phi = 2.0 * pi * s;
        const Vec3 centre(3.0 * std::sin(phi), 1.5 * std::sin(2.0 * phi), 0.0);
        const Vec3 along = Vec3(3.0 * std::cos(phi), 3.0 * std::cos(2.0 * phi), 0.0).normalized();
        return centre + u * along.cross(Vec3::UnitZ()) + v * Vec3::UnitZ();
      });
  const YarnCheck check = check_one(body);
  EXPECT_TRUE(check.closed);
  EXPECT_TRUE(check.self_intersecting);
  ASSERT_TRUE(check.self_intersection_at.has_value());
  EXPECT_LT(check.self_intersection_at->norm(), 0.6);
}

TEST(Check, AnInvertedBodyIsReported) {
  yarn::Body body = straight("tube", {1, 1, 16, 4}, Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 4.0);
  expect_valid(check_one(body));
  yarn::Body turned = body;
  turned.inward = !turned.inward;
  turned.start.inward = !turned.start.inward;
  turned.end.inward = !turned.end.inward;
  const YarnCheck check = check_one(turned);
  EXPECT_TRUE(check.closed);
  EXPECT_FALSE(check.outward);
  EXPECT_TRUE(has_defect(check, "face inward"));
  // One face only: the skin is not of one piece any more.
  yarn::Body mixed = body;
  mixed.end.inward = !mixed.end.inward;
  const YarnCheck half = check_one(mixed);
  EXPECT_FALSE(half.closed);
  EXPECT_TRUE(has_defect(half, "do not all face outward"));
}

TEST(Check, AGridThatRunsTheOtherWayRoundIsStillOutward) {
  const yarn::Body body = test::tube("left", {1, 1, 16, 4}, [](double s, double u, double v) -> Vec3 {
    return {u, -v, 4.0 * s};
  });
  EXPECT_TRUE(body.inward);
  expect_valid(check_one(body));
}

TEST(Check, AVolumeThatTheTrianglesDoNotHaveIsADefect) {
  yarn::Body body = straight("tube", {1, 1, 16, 4}, Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 4.0);
  body.volume *= 1.05;
  EXPECT_TRUE(has_defect(check_one(body), "encloses"));
}

TEST(Check, WhatCannotBeTessellatedIsADefectOfThatYarnOnly) {
  std::vector<yarn::Body> bodies = {straight("bad", {1, 1, 16, 4}, Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 4.0),
                                    straight("good", {1, 1, 16, 4}, {0, 5, 0}, {1, 0, 0}, {0, 1, 0}, 4.0)};
  bodies[0].surface.points[5].z() = std::nan("");
  Result<SolidCheck> result = check_solids(bodies, {});
  ASSERT_TRUE(result.ok());
  EXPECT_TRUE(has_defect(result->yarns[0], "not finite"));
  expect_valid(result->yarns[1]);
}

TEST(Check, ReportsEveryStepOnce) {
  std::vector<yarn::Body> bodies;
  for (int i = 0; i < 5; ++i)
    bodies.push_back(
        straight("t" + std::to_string(i), {1, 1, 16, 4}, {0, 3.0 * i, 0}, {1, 0, 0}, {0, 1, 0}, 4.0));
  CheckOptions options;
  options.threads = 2;
  std::vector<std::size_t> seen;
  options.progress = [&](std::size_t done, std::size_t total) {
    EXPECT_EQ(total, 10U);
    seen.push_back(done);
  };
  ASSERT_TRUE(check_solids(bodies, options).ok());
  ASSERT_EQ(seen.size(), 10U);
  for (std::size_t k = 0; k < seen.size(); ++k) EXPECT_EQ(seen[k], k + 1);
}

}  // namespace
}  // namespace selvage::solid
