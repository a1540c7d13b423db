// `edit` lines, from the model to the plan and the tube.
#include "fabric/edits.h"

#include <gtest/gtest.h>

#include <cmath>

#include "construction/build.h"
#include "nurbs/edit.h"
#include "nurbs/measure.h"

namespace selvage::fabric {
namespace {

// One round yarn of diameter 0.3 in a wave, in the plane y = 0.
Fabric wave(yarn::PathForm form, bool closed = false) {
  Fabric fabric;
  fabric.file = "test.txt";
  Yarn yarn;
  yarn.name = "a";
  yarn.place = {3, 1};
  yarn.own.diameter = 0.3;
  yarn.closed = closed;
  Path path;
  path.form = form;
  path.place = {4, 3};
  for (int i = 0; i < 8; ++i) {
    const double angle = 2.0 * std::acos(-1.0) * i / 8.0;
    path.points.push_back(closed ? Vec3(3.0 * std::cos(angle), 0, 3.0 * std::sin(angle))
                                 : Vec3(i, 0, i % 2 == 0 ? 0.3 : -0.3));
  }
  yarn.shape = path;
  fabric.items = {yarn};
  fabric.tolerance = 0.001;
  return fabric;
}

Edit edit_of(Edit::Form form, int joint, const Vec3& to, double length = 0) {
  Edit edit;
  edit.form = form;
  edit.yarn = "a";
  edit.joint = joint;
  edit.place = {20 + joint, 1};
  edit.length = length;
  (form == Edit::Form::length ? edit.direction : edit.target) = to;
  return edit;
}

Result<YarnPlan> plan_of(const Fabric& fabric) {
  Diagnostics diagnostics;
  const std::optional<YarnBuilder> builder = YarnBuilder::create(fabric, {}, diagnostics);
  if (!builder) return *diagnostics.first_error();
  return builder->plan(0);
}

Vec3 joint_at(const nurbs::Curve& curve, int joint) {
  return nurbs::evaluate(curve,
                         nurbs::breakpoints(curve.knots, curve.degree)[static_cast<std::size_t>(joint - 1)]);
}

TEST(Edits, ApplyInFileOrder) {
  Fabric fabric = wave(yarn::PathForm::chord);
  const Vec3 first(3, 0, 1), second(3.2, 0.4, 0.9);
  fabric.edits = {edit_of(Edit::Form::point, 4, first), edit_of(Edit::Form::point, 4, second),
                  edit_of(Edit::Form::length, 6, Vec3(0, 0, -1), 12.5)};
  Result<YarnPlan> plan = plan_of(fabric);
  ASSERT_TRUE(plan.ok()) << to_string(plan.error());
  EXPECT_LT((joint_at(plan->line.curve, 4) - second).norm(), 1e-13);
  EXPECT_NEAR(nurbs::arc_length(plan->line.curve), 12.5, 1e-10);
  // The later edit of joint 6 moved another control point than those that hold joint 4.
  std::swap(fabric.edits[0], fabric.edits[1]);
  plan = plan_of(fabric);
  ASSERT_TRUE(plan.ok());
  EXPECT_LT((joint_at(plan->line.curve, 4) - first).norm(), 1e-13);
}

TEST(Edits, LeaveEveryOtherControlPointAndTheSizesWhereTheyWere) {
  for (const yarn::PathForm form :
       {yarn::PathForm::chord, yarn::PathForm::uniform, yarn::PathForm::centripetal, yarn::PathForm::control,
        yarn::PathForm::loop}) {
    Fabric fabric = wave(form);
    const Result<YarnPlan> before = plan_of(fabric);
    ASSERT_TRUE(before.ok());
    fabric.edits = {edit_of(Edit::Form::point, 4, joint_at(before->line.curve, 4) + Vec3(0.1, 0.2, 0.3))};
    const Result<YarnPlan> after = plan_of(fabric);
    ASSERT_TRUE(after.ok()) << to_string(after.error());
    int changed = 0;
    for (std::size_t i = 0; i < before->line.curve.points.size(); ++i)
      if (before->line.curve.points[i] != after->line.curve.points[i]) ++changed;
    EXPECT_EQ(changed, 1);
    EXPECT_EQ(before->line.parameters, after->line.parameters);
    EXPECT_EQ(before->line.curve.knots, after->line.curve.knots);
    EXPECT_TRUE(after->line.curve.weights.empty());
  }
}

TEST(Edits, JointsAreWhereTheFormatsPageSaysTheyAre) {
  for (const bool closed : {false, true}) {
    const Fabric chord = wave(yarn::PathForm::chord, closed);
    const Result<YarnPlan> through = plan_of(chord);
    ASSERT_TRUE(through.ok());
    EXPECT_EQ(nurbs::joint_count(through->line.curve, closed), 8);
    for (int k = 1; k <= 8; ++k)
      EXPECT_LT((joint_at(through->line.curve, k) - through->points[static_cast<std::size_t>(k - 1)]).norm(),
                1e-13);
    const Result<YarnPlan> control = plan_of(wave(yarn::PathForm::control, closed));
    const Result<YarnPlan> loop = plan_of(wave(yarn::PathForm::loop, closed));
    ASSERT_TRUE(control.ok() && loop.ok());
    EXPECT_EQ(nurbs::joint_count(control->line.curve, closed), closed ? 8 : 8 - 2);
    EXPECT_EQ(nurbs::joint_count(loop->line.curve, closed), closed ? 2 * 8 : 2 * 8 - 4);
    for (int k = 1; closed && k <= 8; ++k) {
      const Vec3& row = control->points[static_cast<std::size_t>(k - 1)];
      EXPECT_LT(joint_at(control->line.curve, k).normalized().cross(row.normalized()).norm(), 1e-13);
    }
  }
}

// The tube of a centre line with weights against its exact swept circle: every point of the surface at the
// distance of the radius from the centre line, in the plane across it.
TEST(Edits, TheTubeOfARationalCentreLineKeepsItsBound) {
  for (const bool closed : {false, true}) {
    Fabric fabric = wave(yarn::PathForm::chord, closed);
    const Result<YarnPlan> plain = plan_of(fabric);
    ASSERT_TRUE(plain.ok());
    const Vec3 joint = joint_at(plain->line.curve, 4);
    // Toward the inside of the control triangle of joint 4, off every line of one weight.
    const Vec3 target = joint + (closed ? Vec3(0.03, 0, -0.04) : Vec3(0.05, 0, 0.06));
    fabric.edits = {edit_of(Edit::Form::weight, 4, target)};
    Diagnostics diagnostics;
    const std::optional<YarnBuilder> builder = YarnBuilder::create(fabric, {}, diagnostics);
    ASSERT_TRUE(builder.has_value());
    const Result<yarn::Body> body = builder->build(0);
    ASSERT_TRUE(body.ok()) << to_string(body.error());
    ASSERT_TRUE(body->axis.is_rational());
    EXPECT_LT((joint_at(body->axis, 4) - target).norm(), 1e-13);
    EXPECT_LE(body->tube_error, 0.001);
    double worst = 0.0;
    constexpr int along = 2000, round = 40;
    for (int j = 0; j <= along; ++j) {
      const double v = static_cast<double>(j) / along;
      for (int i = 0; i < round; ++i) {
        // Its distance from the centre line: a section may slide along it, which leaves the tube where it is.
        const Vec3 p = nurbs::evaluate(body->surface, static_cast<double>(i) / round, v);
        double t = v;
        for (int k = 0; k < 5; ++k) {
          const nurbs::CurveJet jet = nurbs::evaluate_jet(body->axis, t);
          const Vec3 arm = p - jet.position;
          t = std::clamp(t + arm.dot(jet.d1) / (jet.d1.squaredNorm() - arm.dot(jet.d2)), 0.0, 1.0);
        }
        worst = std::max(worst, std::abs((p - nurbs::evaluate(body->axis, t)).norm() - 0.15));
      }
    }
    EXPECT_LE(worst, body->tube_error);
    EXPECT_GT(worst, 0.1 * body->tube_error);
    EXPECT_NEAR(body->length, nurbs::arc_length(body->axis), 1e-12);
    // Pappus: the volume of a tube is its section times the length of its centre line.
    EXPECT_NEAR(body->volume / (std::acos(-1.0) * 0.15 * 0.15 * body->length), 1.0, 0.01);
  }
}

std::string refusal(const Fabric& fabric) {
  const Result<YarnPlan> plan = plan_of(fabric);
  return plan.ok() ? "built" : to_string(plan.error());
}

TEST(Edits, AreRefusedAtTheirLines) {
  Fabric fabric = wave(yarn::PathForm::chord);
  fabric.edits = {edit_of(Edit::Form::point, 9, Vec3(0, 0, 0))};
  EXPECT_EQ(refusal(fabric), "test.txt:29:1: error: there is no joint 9: the centre line has 8 (yarn 'a')");
  fabric.edits = {edit_of(Edit::Form::weight, 4, Vec3(3, 2, 0))};
  EXPECT_NE(refusal(fabric).find("test.txt:24:1: error: no weights bring joint 4 to (3, 2, 0)"),
            std::string::npos)
      << refusal(fabric);
  fabric.edits = {edit_of(Edit::Form::length, 4, Vec3(0, 0, 1), 3.0)};
  EXPECT_NE(refusal(fabric).find("test.txt:24:1: error: joint 4 moved along (0, 0, 1)"), std::string::npos)
      << refusal(fabric);
  Fabric corners = wave(yarn::PathForm::polyline);
  for (const int joint : {1, 2}) {
    corners.edits = {edit_of(Edit::Form::point, joint, Vec3(0, 0, 0))};
    EXPECT_NE(refusal(corners).find("straights and arcs"), std::string::npos) << refusal(corners);
  }
}

}  // namespace
}  // namespace selvage::fabric
