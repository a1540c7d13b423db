// Rotation-minimizing frames where they are known.
#include "yarn/frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "nurbs/interpolate.h"

namespace selvage::yarn {
namespace {

using std::numbers::pi;

nurbs::Curve helix(double radius, double pitch, double turns, int per_turn) {
  std::vector<Vec3> points;
  const int n = static_cast<int>(turns * per_turn);
  for (int i = 0; i <= n; ++i) {
    const double a = 2 * pi * i / per_turn;
    points.emplace_back(radius * std::cos(a), radius * std::sin(a), pitch * i / per_turn);
  }
  const std::vector<double> t = nurbs::parameters(points, nurbs::Parameterization::uniform);
  const double da = 2 * pi * turns;
  const Vec3 d0 = da * Vec3(0, radius, pitch / (2 * pi));
  const double end = 2 * pi * turns;
  const Vec3 d1 = da * Vec3(-radius * std::sin(end), radius * std::cos(end), pitch / (2 * pi));
  return nurbs::interpolate(points, t, d0, d1);
}

TEST(FrameTest, OnAHelixTheFrameTurnsAgainstTheNormalByTheTorsion) {
  const double radius = 1.0, pitch = 2.0, turns = 2.25;
  const nurbs::Curve curve = helix(radius, pitch, turns, 64);
  const Result<FrameField> field = FrameField::make(curve, FrameGuide::free_from(Vec3(-1, 0, 0)),
                                                    false);  // the principal normal at the start
  ASSERT_TRUE(field.ok());
  const double c = pitch / (2 * pi), torsion = c / (radius * radius + c * c);
  for (double t : {0.1, 0.37, 0.71, 1.0}) {
    const Frame frame = field->at(t);
    const double a = 2 * pi * turns * t;
    const Vec3 normal(-std::cos(a), -std::sin(a), 0);
    const Vec3 binormal = frame.tangent.cross(normal);
    // Against the normal the rotation-minimizing frame falls back by torsion times arc length.
    const double turned = std::atan2(frame.up.dot(binormal), frame.up.dot(normal));
    const double expected = -torsion * field->length_at(t);
    EXPECT_NEAR(std::remainder(turned - expected, 2 * pi), 0.0, 2e-4)
        << t;  // the cubic is not quite the helix
    EXPECT_NEAR(frame.across.cross(frame.up).dot(frame.tangent), 1.0, 1e-12);
  }
  EXPECT_NEAR(field->length(), turns * std::hypot(2 * pi * radius, pitch), 1e-5);
}

TEST(FrameTest, APlanePathKeepsItsNormal) {
  std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0.3}, {2, 0, -0.2}, {3, 0, 0}};
  const std::vector<double> t = nurbs::parameters(points, nurbs::Parameterization::chord);
  const nurbs::Curve curve = nurbs::interpolate(points, t, nurbs::end_derivative(points, t, false),
                                                nurbs::end_derivative(points, t, true));
  const Result<FrameField> field = FrameField::make(curve, FrameGuide{}, false);
  ASSERT_TRUE(field.ok());
  for (double s = 0; s <= 1; s += 0.05) EXPECT_LT((field->at(s).across - Vec3(0, 1, 0)).norm(), 1e-13);
}

TEST(FrameTest, ClosedPathsCloseTheirFrames) {
  // Not flat, so that the carried frame does not come back by itself.
  std::vector<Vec3> points;
  for (int i = 0; i < 24; ++i) {
    const double a = 2 * pi * i / 24;
    points.emplace_back(3 * std::cos(a), 3 * std::sin(a), std::sin(2 * a) + 0.4 * std::cos(3 * a));
  }
  const nurbs::Curve curve =
      nurbs::interpolate_closed(points, nurbs::parameters(points, nurbs::Parameterization::chord, true));
  const Result<FrameField> field = FrameField::make(curve, FrameGuide{}, true);
  ASSERT_TRUE(field.ok());
  EXPECT_GT(field->turn_between(0.0, 1.0), 1e-3);
  EXPECT_LT((field->at(0.0).up - field->at(1.0).up).norm(), 1e-9);
  EXPECT_LT((field->at(0.0).across - field->at(1.0).across).norm(), 1e-9);
}

TEST(FrameTest, UpRules) {
  const auto straight = [](const Vec3& to) {
    const std::vector<Vec3> points = {Vec3::Zero(), to};
    return nurbs::interpolate(points, {0, 1}, to, to);
  };
  EXPECT_LT((FrameField::make(straight({1, 0, 0}), FrameGuide{}, false)->at(0).up - Vec3(0, 0, 1)).norm(),
            1e-15);
  EXPECT_LT((FrameField::make(straight({0, 0, 2}), FrameGuide{}, false)->at(0).up - Vec3(0, 1, 0)).norm(),
            1e-15);
  EXPECT_LT((FrameField::make(straight({0, 0, -2}), FrameGuide{}, false)->at(0.3).up - Vec3(0, 1, 0)).norm(),
            1e-15);
  EXPECT_FALSE(FrameField::make(straight({0, 0, 1}), FrameGuide::free_from(Vec3(0.05, 0, 1)), false).ok());
  EXPECT_TRUE(FrameField::make(straight({0, 0, 1}), FrameGuide::free_from(Vec3(0.2, 0, 1)), false).ok());
}

// A helix about the z axis, through enough points to be one to 1e-5.
nurbs::Curve helix(double radius, double rise, double turns) {
  std::vector<Vec3> points;
  const int steps = static_cast<int>(64 * turns);
  for (int i = 0; i <= steps; ++i) {
    const double a = 2 * pi * i / 64;
    points.emplace_back(radius * std::cos(a), radius * std::sin(a), rise * a / (2 * pi));
  }
  const std::vector<double> t = nurbs::parameters(points, nurbs::Parameterization::uniform);
  return nurbs::interpolate(points, t, nurbs::end_derivative(points, t, false),
                            nurbs::end_derivative(points, t, true));
}

TEST(FrameTest, GuidedFramesHoldTheirDirectionAndKnowTheirTurn) {
  const nurbs::Curve curve = helix(2, 5, 1.5);
  const Vec3 z = Vec3::UnitZ();
  for (const FrameGuide& guide :
       {FrameGuide::with_up(z), FrameGuide::with_across(z), FrameGuide::about_axis(Vec3::Zero(), z)}) {
    const Result<FrameField> field = FrameField::make(curve, guide, false);
    ASSERT_TRUE(field.ok());
    for (double t = 0.013; t < 0.98; t += 0.031) {
      const Frame frame = field->at(t);
      EXPECT_NEAR(frame.up.norm(), 1, 1e-14);
      EXPECT_LT((frame.across.cross(frame.up) - frame.tangent).norm(), 1e-14);
      Vec3 wanted = z;
      if (guide.form == FrameGuide::Form::radial)
        wanted = Vec3(frame.position.x(), frame.position.y(), 0).normalized();
      const Vec3& held = guide.form == FrameGuide::Form::across ? frame.across : frame.up;
      const Vec3& other = guide.form == FrameGuide::Form::across ? frame.up : frame.across;
      EXPECT_GT(held.dot(wanted), 0.3);
      EXPECT_LT(std::abs(other.dot(wanted)), 1e-12);
      // turn_dt against a central difference of the frame itself.
      const double h = 1e-5;
      const Vec3 across_dt = (field->at(t + h).across - field->at(t - h).across) / (2 * h);
      EXPECT_NEAR(frame.turn_dt, across_dt.dot(frame.up), 1e-6 * (1 + std::abs(frame.turn_dt)));
    }
  }
}

// On a mandrel the rotation-minimizing frame of a 45 degree helix turns against the radial one by
// 2 pi sin(45 degrees) a turn of the helix: the torsion's integral.
TEST(FrameTest, TheRadialFrameOfAHelixTurnsByItsTorsion) {
  const double radius = 2, rise = 2 * pi * radius;
  const Result<FrameField> field =
      FrameField::make(helix(radius, rise, 2), FrameGuide::about_axis(Vec3::Zero(), Vec3::UnitZ()), false);
  ASSERT_TRUE(field.ok());
  EXPECT_NEAR(field->turn_between(0, 1), 2 * 2 * pi * std::sin(pi / 4), 2e-3);
}

TEST(FrameTest, AGuideAlongThePathIsRefused) {
  const nurbs::Curve curve = helix(2, 5, 1);
  const Vec3 along = nurbs::evaluate_jet(curve, 0.4).d1;
  EXPECT_FALSE(FrameField::make(curve, FrameGuide::with_up(along), false).ok());
  EXPECT_FALSE(FrameField::make(curve, FrameGuide::with_across(along), false).ok());
}

// A straight way up with a short bow in one span, steepest in its middle, between the places that are looked
// at first: refused or not as the steepest place says.
TEST(FrameTest, AGuideThatIsIdleBetweenTheKnotsIsRefused) {
  for (const bool needs_lengths : {false, true})
    for (const double rise : {1.0, 10.0, 14.0, 14.2, 14.35, 14.6, 30.0}) {
      nurbs::Curve curve;
      curve.degree = 3;
      curve.knots = {0, 0, 0, 0, 1, 1, 1, 1};
      curve.points = {{0, 0, 0}, {1, 0, 0}, {1.5, 0, rise}, {2.5, 0, rise}};
      double steepest = 0;  // degrees
      for (int i = 0; i <= 4000; ++i) {
        const Vec3 way = nurbs::evaluate_jet(curve, i / 4000.0).d1;
        steepest = std::max(steepest, std::atan2(way.z(), way.x()) * 180 / pi);
      }
      const bool is_held =
          FrameField::make(curve, FrameGuide::with_up(Vec3::UnitZ()), false, needs_lengths).ok();
      if (std::abs(steepest - 84) < 0.01) continue;
      EXPECT_EQ(is_held, steepest < 84) << rise << ", " << steepest;
    }
}

}  // namespace
}  // namespace selvage::yarn
