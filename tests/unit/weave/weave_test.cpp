// Woven centre lines against Peirce's geometry and what follows from it, and what cannot be woven.

#include <fmt/format.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "construction/build.h"
#include "nurbs/measure.h"
#include "weave/interlacing.h"

namespace selvage::fabric {
namespace {

using std::numbers::pi;

Thread thread_of(std::string name, yarn::Section section) {
  Thread thread;
  thread.name = std::move(name);
  thread.place = {2, 1};
  thread.section = section;
  return thread;
}

// Plain weave of 4 x 4; warp at line 5, weft at line 6.
Fabric woven(const yarn::Section& warp, double warp_pitch, const yarn::Section& weft, double weft_pitch) {
  Fabric fabric;
  fabric.file = "test.txt";
  fabric.tolerance = 1e-15;  // as published, yarns that cross keep twice that free: nothing that tests see
  fabric.threads = {thread_of("a", warp), thread_of("b", weft)};
  Weave weave;
  weave.place = {4, 1};
  weave.warp = {{"a"}, {5, 3}, 4, warp_pitch};
  weave.weft = {{"b"}, {6, 3}, 4, weft_pitch};
  fabric.items = {weave};
  return fabric;
}
Fabric square(double diameter, double pitch) {
  return woven(yarn::Circle{diameter}, pitch, yarn::Circle{diameter}, pitch);
}

Weave& weave_of(Fabric& fabric) {
  return std::get<Weave>(fabric.items.front());
}

const BuildOptions as_published = [] {
  BuildOptions options;
  options.as_published = true;
  return options;
}();

YarnBuilder builder_of(const Fabric& fabric, const BuildOptions& options = as_published) {
  Diagnostics diagnostics;
  std::optional<YarnBuilder> builder = YarnBuilder::create(fabric, options, diagnostics);
  if (!builder) throw std::runtime_error(to_string(*diagnostics.first_error()));
  return std::move(*builder);
}

YarnPlan plan_of(const Fabric& fabric, const char* name, const BuildOptions& options = as_published) {
  const YarnBuilder builder = builder_of(fabric, options);
  Result<YarnPlan> plan = builder.plan(builder.find(name).value());
  if (!plan) throw std::runtime_error(to_string(plan.error()));
  return std::move(*plan);
}

yarn::Body body_of(Fabric fabric, const char* name) {
  fabric.tolerance = 3e-4;
  const YarnBuilder builder = builder_of(fabric);
  Result<yarn::Body> body = builder.build(builder.find(name).value());
  if (!body) throw std::runtime_error(to_string(body.error()));
  return std::move(*body);
}

Message refusal_of(const Fabric& fabric, const BuildOptions& options = {}) {
  Diagnostics diagnostics;
  EXPECT_FALSE(YarnBuilder::create(fabric, options, diagnostics).has_value());
  return diagnostics.first_error() != nullptr ? *diagnostics.first_error() : Message{};
}

std::vector<Vec3> samples_of(const nurbs::Curve& curve, int count) {
  std::vector<Vec3> samples;
  for (int i = 0; i <= count; ++i) samples.push_back(nurbs::evaluate(curve, static_cast<double>(i) / count));
  return samples;
}

double steepest(const nurbs::Curve& curve) {
  double angle = 0.0;
  for (int i = 0; i <= 2000; ++i) {
    const Vec3 d = nurbs::evaluate_jet(curve, i / 2000.0).d1;
    angle = std::max(angle, std::atan2(std::abs(d.z()), std::hypot(d.x(), d.y())));
  }
  return angle;
}

// Peirce's formulas; angle in radians.
double peirce_pitch(double length, double spread, double angle) {
  return (length - spread * angle) * std::cos(angle) + spread * std::sin(angle);
}

double peirce_height(double length, double spread, double angle) {
  return (length - spread * angle) * std::sin(angle) + spread * (1.0 - std::cos(angle));
}

TEST(Weave, PeircesFormulasGiveTheirPublishedNumbers) {
  const double t = pi / 6.0;
  EXPECT_NEAR(peirce_pitch(1.5, 1.0, t), 1.34559, 1e-5);
  EXPECT_NEAR(peirce_height(1.5, 1.0, t), 0.62218, 1e-5);
  const double jammed = pi / 3.0;
  EXPECT_NEAR(peirce_pitch(jammed, 1.0, jammed), 0.8660, 1e-4);
  EXPECT_NEAR(peirce_height(jammed, 1.0, jammed), 0.5, 1e-12);
}

TEST(Weave, BridgesAreTheInverseOfPeircesFormulas) {
  for (const double spread : {0.3, 1.0, 7.0})
    for (const double angle : {0.05, 0.3, 0.9, 1.5})
      for (const double straight : {0.0, 0.01, 2.0}) {
        const double length = spread * angle + straight;
        const double pitch = peirce_pitch(length, spread, angle),
                     height = peirce_height(length, spread, angle);
        const std::optional<Bridge> bridge = find_bridge(pitch, height, spread);
        ASSERT_TRUE(bridge.has_value());
        EXPECT_NEAR(bridge->angle, angle, 1e-6);  // without a straight the angle is a square root's
        EXPECT_NEAR(peirce_pitch(bridge->straight + spread * bridge->angle, spread, bridge->angle), pitch,
                    1e-12 * spread);
      }
}

TEST(Weave, TheSmallestPitchAndTheLargestHeightAreWhereBridgesEnd) {
  for (const double height : {0.1, 0.5, 0.9, 1.0, 1.7}) {
    const double least = smallest_pitch(height, 1.0);
    EXPECT_TRUE(find_bridge(least * (1 + 1e-9), height, 1.0).has_value()) << height;
    EXPECT_FALSE(find_bridge(least * (1 - 1e-6), height, 1.0).has_value()) << height;
    if (height < 1.0) {
      EXPECT_NEAR(largest_height(least, 1.0), height, 1e-12);
    }
  }
  EXPECT_FALSE(find_bridge(-1.0, 0.1, 1.0).has_value());
}

// D = 1, 1.5 between crossings at 30 degrees: what the formulas give is what stands in the built cloth.
TEST(Weave, TheWarpOfAPeirceClothHasItsLengthAndAngle) {
  Fabric fabric = woven(yarn::Circle{0.4}, 1.5, yarn::Circle{0.6}, peirce_pitch(1.5, 1.0, pi / 6.0));
  weave_of(fabric).crimp = peirce_height(1.5, 1.0, pi / 6.0);
  const YarnPlan warp = plan_of(fabric, "warp_1");
  // Four pitches; the first and the last half are level at the ends: 3 bridges and two halves of a pitch.
  const double pitch = weave_of(fabric).weft.pitch;
  EXPECT_NEAR(nurbs::arc_length(warp.line.curve), 3 * 1.5 + pitch, 1e-9);
  EXPECT_NEAR(steepest(warp.line.curve), pi / 6.0, 1e-9);
  EXPECT_NEAR(warp.points[1].z() - warp.points[0].z(), -0.62218, 1e-5);
}

TEST(Weave, AJammedSquareClothHasPeircesCrimpAndIsTheTightest) {
  Fabric fabric = square(0.5, std::sqrt(0.75));
  const YarnPlan warp = plan_of(fabric, "warp_2");
  const double pitch = weave_of(fabric).weft.pitch;
  const double between = (nurbs::arc_length(warp.line.curve) - pitch) / 3.0;
  EXPECT_NEAR(between / pitch - 1.0, 0.2092, 1e-4);
  EXPECT_NEAR(steepest(warp.line.curve), pi / 3.0, 1e-6);

  Fabric tighter = square(0.5, 0.86);
  weave_of(tighter).profile = Weave::Profile::peirce;
  const Message message = refusal_of(tighter);
  EXPECT_EQ(message.kind, Kind::geometry);
  EXPECT_EQ(message.place.line, 6);
  EXPECT_NE(message.text.find("0.866025"), std::string::npos) << message.text;
}

// Where one system is too tight for half of the crimp, it takes what it has room for.
TEST(Weave, ATightSystemTakesTheNearestShareThatItHasRoomFor) {
  const Fabric fabric = woven(yarn::Circle{0.5}, 2.0, yarn::Circle{0.5}, 0.7);
  const YarnPlan warp = plan_of(fabric, "warp_1"), weft = plan_of(fabric, "weft_1");
  const double warp_rise = std::abs(warp.points[1].z() - warp.points[0].z()),
               weft_rise = std::abs(weft.points[1].z() - weft.points[0].z());
  EXPECT_NEAR(warp_rise, 1.0 - std::sqrt(1.0 - 0.49), 1e-12);  // D - sqrt(D^2 - p^2)
  EXPECT_NEAR(warp_rise + weft_rise, 1.0, 1e-12);

  Fabric wanted = fabric;
  weave_of(wanted).crimp = 0.5;
  weave_of(wanted).profile = Weave::Profile::peirce;
  EXPECT_EQ(refusal_of(wanted).place.line, 6);
}

// Axes bent on half the sum of both diameters never come nearer than that.
TEST(Weave, RoundYarnsTouchAtCrossingsAndComeNoNearerAnywhere) {
  for (const Fabric& fabric : {square(0.5, std::sqrt(0.75)), square(0.3, 0.7),
                               woven(yarn::Circle{0.2}, 0.9, yarn::Circle{0.5}, 0.8)}) {
    const YarnPlan warp = plan_of(fabric, "warp_2"), weft = plan_of(fabric, "weft_3");
    const double spread = 0.5 * (warp.spec.sizes.front().size.height + weft.spec.sizes.front().size.height);
    double least = std::numeric_limits<double>::infinity();
    const std::vector<Vec3> on_weft = samples_of(weft.line.curve, 1000);
    for (const Vec3& a : samples_of(warp.line.curve, 1000))
      for (const Vec3& b : on_weft) least = std::min(least, (a - b).norm());
    EXPECT_GE(least, spread - 1e-9);
    const Vec3 crossing(weft.points[0].x(), warp.points[0].y(), 0.0);
    EXPECT_NEAR(std::abs(warp.points[2].z() - weft.points[1].z()), spread, 1e-12);
    EXPECT_NEAR(warp.points[2].x(), crossing.x(), 1e-15);
  }
}

TEST(Weave, ATubesVolumeIsItsSectionTimesItsAxis) {
  const Fabric fabric = square(0.3, 0.7);
  const yarn::Body body = body_of(fabric, "warp_1");
  const double axis = nurbs::arc_length(body.axis);
  EXPECT_NEAR(body.volume, 0.25 * pi * 0.09 * axis, 0.01 * body.volume);
  EXPECT_NEAR(body.length, axis, 1e-3);
}

TEST(Weave, YarnsEndInThePlanesOfTheClothsEdges) {
  const Fabric fabric = woven(yarn::Lenticular{1.2, 0.2}, 1.5, yarn::Circle{0.3}, 2.0);
  const yarn::Body warp = body_of(fabric, "warp_3"), weft = body_of(fabric, "weft_1");
  for (const bool last : {false, true}) {
    for (const Vec3& point : nurbs::boundary_row(warp.surface, last).points)
      EXPECT_NEAR(point.x(), last ? 8.0 : 0.0, 1e-12);
    for (const Vec3& point : nurbs::boundary_row(weft.surface, last).points)
      EXPECT_NEAR(point.y(), last ? 6.0 : 0.0, 1e-12);
  }
  // The lens lies flat in the cloth: wide across the warp.
  double low = 0.0, high = 10.0;
  for (const Vec3& point : nurbs::boundary_row(warp.surface, false).points) {
    low = std::max(low, point.y());
    high = std::min(high, point.y());
  }
  EXPECT_NEAR(low - high, 1.2, 0.01);
}

TEST(Weave, WithACellYarnsGoOnByFourPitches) {
  Fabric fabric = square(0.3, 0.7);
  fabric.cell = Cell{};
  fabric.cell->low = {0, -0.8, -1};
  fabric.cell->high = {2.8, 2.8, 1};
  const std::vector<Vec3> warp = samples_of(plan_of(fabric, "warp_1").line.curve, 1);
  EXPECT_NEAR(warp.front().x(), -4 * 0.7, 1e-12);
  EXPECT_NEAR(warp.back().x(), 2.8 + 4 * 0.7, 1e-12);
  const std::vector<Vec3> weft = samples_of(plan_of(fabric, "weft_2").line.curve, 1);
  EXPECT_NEAR(weft.front().y(), -6 * 0.7, 1e-12);
  EXPECT_NEAR(weft.back().y(), 2.8 + 4 * 0.7, 1e-12);
}

// To the last bit: a yarn a repeat further on has the same points, moved by one product.
TEST(Weave, RepeatsAreExact) {
  for (const std::optional<Weave::Profile> profile :
       {std::optional<Weave::Profile>(), std::optional(Weave::Profile::sine)}) {
    Fabric fabric = woven(yarn::Circle{0.3}, 0.7, yarn::Circle{0.25}, 0.9);
    Weave& weave = weave_of(fabric);
    weave.profile = profile;
    weave.draft.form = Draft::Form::twill;
    weave.draft.a = 2;
    weave.draft.b = 1;
    weave.warp.count = 40;
    weave.weft.count = 40;
    const YarnPlan one = plan_of(fabric, "warp_2"), later = plan_of(fabric, "warp_38");
    ASSERT_EQ(one.points.size(), later.points.size());
    for (std::size_t k = 0; k < one.points.size(); ++k) {
      EXPECT_EQ(one.points[k].x(), later.points[k].x());
      EXPECT_EQ(one.points[k].z(), later.points[k].z());
      EXPECT_EQ(one.points[k].y(), 1.5 * 0.7);
      EXPECT_EQ(later.points[k].y(), 37.5 * 0.7);
    }
    const std::size_t a_crossing = one.points.size() / 40, ahead = 3 * a_crossing;
    // Beyond the first and last crossing a yarn is level.
    for (std::size_t k = a_crossing; k + ahead + a_crossing < one.points.size(); ++k)
      EXPECT_EQ(one.points[k].z(), one.points[k + ahead].z()) << k;
  }
}

// The tubes stay apart by what their models may be off.
TEST(Weave, YarnsThatCrossKeepTwiceTheToleranceFree) {
  Fabric fabric = square(0.3, 0.7);
  fabric.tolerance = 1e-3;
  const YarnPlan warp = plan_of(fabric, "warp_2"), weft = plan_of(fabric, "weft_3");
  EXPECT_NEAR(std::abs(warp.points[2].z() - weft.points[1].z()), 0.3 + 2e-3, 1e-12);
  double least = std::numeric_limits<double>::infinity();
  const std::vector<Vec3> on_weft = samples_of(weft.line.curve, 1000);
  for (const Vec3& a : samples_of(warp.line.curve, 1000))
    for (const Vec3& b : on_weft) least = std::min(least, (a - b).norm());
  EXPECT_GE(least, 0.3 + 2e-3 - 1e-9);

  // Without room for it they touch.
  Fabric jammed = square(0.5, std::sqrt(0.75));
  jammed.tolerance = 1e-3;
  const double rise = plan_of(jammed, "warp_1").points[0].z() - plan_of(jammed, "warp_1").points[1].z();
  EXPECT_NEAR(std::abs(rise), 0.5, 1e-12);
}

// How near two centre lines come.
double least_distance(const YarnPlan& a, const YarnPlan& b) {
  double least = std::numeric_limits<double>::infinity();
  const std::vector<Vec3> on_b = samples_of(b.line.curve, 1500);
  for (const Vec3& p : samples_of(a.line.curve, 1500))
    for (const Vec3& q : on_b) least = std::min(least, (p - q).norm());
  return least;
}

TEST(Weave, YarnsKeepOneHundredthOfTheirThicknessFree) {
  Fabric fabric = woven(yarn::Circle{0.2}, 0.9, yarn::Circle{0.5}, 0.8);
  weave_of(fabric).profile = Weave::Profile::peirce;
  const YarnPlan warp = plan_of(fabric, "warp_2", {}), weft = plan_of(fabric, "weft_3", {});
  EXPECT_NEAR(least_distance(warp, weft), 0.35 + 0.002, 1e-6);
  EXPECT_EQ(warp.spec.sizes.front().size.height, 0.2);
}

// No room between them: half of that is taken from the yarns, whose centre lines stay as they are.
TEST(Weave, YarnsOfAJammedClothBecomeThinnerSoThatTheyDoNotTouch) {
  Fabric jammed = square(0.5, std::sqrt(0.75));
  weave_of(jammed).profile = Weave::Profile::peirce;
  const YarnPlan warp = plan_of(jammed, "warp_2", {}), weft = plan_of(jammed, "weft_3", {});
  const double thickness = warp.spec.sizes.front().size.height;
  EXPECT_NEAR(thickness, 0.5 - 0.0025, 1e-5);
  EXPECT_EQ(warp.spec.sizes.front().size.width, thickness);
  EXPECT_NEAR(least_distance(warp, weft), 0.5, 1e-4);
  EXPECT_GE(least_distance(warp, weft), thickness + 0.0024);
  Diagnostics diagnostics;
  EXPECT_TRUE(YarnBuilder::create(jammed, {}, diagnostics).has_value());
  ASSERT_EQ(diagnostics.messages().size(), 1U);
  EXPECT_EQ(diagnostics.messages().front().place.line, 4);
  EXPECT_NE(diagnostics.messages().front().text.find("jammed"), std::string::npos);
}

// Ellipses 0.8 x 0.2 at a pitch of 1 touch at the amplitude 0.1178 (measured on their surfaces, +- 0.0002);
// from there the gap grows by no more than twice the amplitude, and by about 0.9 of it on the slopes.
TEST(Weave, TheAmplitudeOfSinesIsTheSmallestThatKeepsTheirFlanksFree) {
  Fabric fabric = woven(yarn::Ellipse{0.8, 0.2}, 1.0, yarn::Ellipse{0.8, 0.2}, 1.0);
  weave_of(fabric).profile = Weave::Profile::sine;
  const auto amplitude = [&](const BuildOptions& options) {
    double highest = 0.0;
    for (const Vec3& point : plan_of(fabric, "warp_2", options).points)
      highest = std::max(highest, point.z());
    return highest;
  };
  EXPECT_NEAR(amplitude(as_published), 0.1, 1e-12);
  EXPECT_GT(amplitude({}), 0.1178 + 0.001);
  EXPECT_LT(amplitude({}), 0.1178 + 0.0028);
  weave_of(fabric).amplitude = 0.09;
  EXPECT_NEAR(amplitude({}), 0.09, 1e-12);
}

TEST(Weave, LayersAreATrueThicknessApartAboutTheMiddle) {
  Fabric fabric = square(0.3, 0.7);
  weave_of(fabric).layers = 3;
  double lowest[3], highest[3];
  for (int layer = 0; layer < 3; ++layer) {
    lowest[layer] = 10.0;
    highest[layer] = -10.0;
    for (const char* kind : {"warp_1", "weft_1"}) {
      const std::string name = "layer" + std::to_string(layer + 1) + "_" + kind;
      for (const Vec3& point : samples_of(plan_of(fabric, name.c_str()).line.curve, 1000)) {
        lowest[layer] = std::min(lowest[layer], point.z() - 0.15);
        highest[layer] = std::max(highest[layer], point.z() + 0.15);
      }
    }
  }
  EXPECT_NEAR(highest[0], lowest[1], 1e-9);
  EXPECT_NEAR(highest[1], lowest[2], 1e-9);
  EXPECT_NEAR(lowest[0], -highest[2], 1e-9);
  EXPECT_NEAR(highest[1], 0.3, 1e-9);
}

// What has to be held at once is refused before it is computed; and what is announced is enough for what is
// made.
TEST(Weave, AYarnOfTooManyDataPointsIsRefusedBeforeItIsBuilt) {
  for (const auto profile : {Weave::Profile::peirce, Weave::Profile::sine}) {
    Fabric fabric = square(0.3, 0.7);
    weave_of(fabric).profile = profile;
    const std::size_t needed = plan_of(fabric, "warp_1").points.size();
    BuildOptions options;
    options.max_control_points = 8 * (needed - 1);
    const Message message = refusal_of(fabric, options);
    EXPECT_EQ(message.kind, Kind::limit);
    EXPECT_EQ(message.place.line, 4);
    EXPECT_NE(message.text.find("one of its yarns"), std::string::npos) << message.text;
    options.max_control_points = 8 * 2 * needed;
    Diagnostics diagnostics;
    EXPECT_TRUE(YarnBuilder::create(fabric, options, diagnostics).has_value());
  }
}

TEST(Weave, ThreadsAreUsedInTurn) {
  Fabric fabric = square(0.3, 0.7);
  weave_of(fabric).warp.threads = {"a", "a", "b"};
  EXPECT_EQ(plan_of(fabric, "warp_2").thread_name, "a");
  EXPECT_EQ(plan_of(fabric, "warp_3").thread_name, "b");
  EXPECT_EQ(plan_of(fabric, "warp_4").thread_name, "a");
  EXPECT_EQ(plan_of(fabric, "warp_4").role, Role::warp);
}

TEST(Weave, YarnsWiderThanTheirPitchAreWarnedOf) {
  Fabric fabric = woven(yarn::Lenticular{1.2, 0.1}, 1.1, yarn::Lenticular{1.0, 0.1}, 2.0);
  weave_of(fabric).profile = Weave::Profile::lenticular;
  Diagnostics diagnostics;
  EXPECT_TRUE(YarnBuilder::create(fabric, {}, diagnostics).has_value());
  ASSERT_EQ(diagnostics.messages().size(), 1U);
  EXPECT_EQ(diagnostics.messages().front().place.line, 5);
  EXPECT_NE(diagnostics.messages().front().text.find("1.2"), std::string::npos);
}

TEST(Weave, WhatIsTooLargeIsRefusedBeforeItIsBuilt) {
  constexpr int most = std::numeric_limits<int>::max();
  Fabric wide = square(0.3, 0.7);
  weave_of(wide).warp.count = 1'000'000'000;
  EXPECT_EQ(refusal_of(wide).kind, Kind::limit);
  Fabric all = square(0.3, 0.7);
  weave_of(all).warp.count = weave_of(all).weft.count = most;
  weave_of(all).layers = 1000;
  EXPECT_EQ(refusal_of(all).kind, Kind::limit);
  weave_of(all).layers = most;
  EXPECT_EQ(refusal_of(all).kind, Kind::limit);
  Fabric bound = square(0.3, 0.7);
  weave_of(bound).profile = Weave::Profile::straight;
  weave_of(bound).weft.count = most;
  weave_of(bound).binders.push_back({"a", {8, 3}, 1, 1, {0, 1, 2}});
  EXPECT_EQ(refusal_of(bound).kind, Kind::limit);
  Fabric far = square(0.3, 0.7);
  far.cell = Cell{};
  far.cell->high = {1e8, 1, 1};
  EXPECT_EQ(refusal_of(far).kind, Kind::limit);
}

TEST(Weave, BindersThatCannotBeAreRefusedAtTheirLines) {
  const auto refused = [](const Binder& binder) {
    Fabric fabric = woven(yarn::Racetrack{1.4, 0.4}, 2.0, yarn::Racetrack{1.2, 0.4}, 2.0);
    fabric.threads.push_back(thread_of("c", yarn::Racetrack{0.4, 0.2}));
    Weave& weave = weave_of(fabric);
    weave.profile = Weave::Profile::straight;
    weave.layers = 2;
    weave.binders = {binder};
    return refusal_of(fabric);
  };
  EXPECT_EQ(refused({"c", {8, 3}, 1, 1, {0, 4}}).place.line, 8);
  EXPECT_EQ(refused({"c", {9, 3}, 1, 4, {0, 3}}).place.line, 9);
  EXPECT_EQ(refused({"d", {10, 3}, 1, 1, {0, 3}}).place.line, 10);
}

TEST(Weave, WarpsOfAColumnLieAboveEachOtherInTheirOrder) {
  Fabric fabric = square(0.3, 0.8);
  fabric.threads.push_back(thread_of("c", yarn::Circle{0.4}));
  Weave& weave = weave_of(fabric);
  weave.warp.count = 3;
  weave.layers = 2;
  weave.columns = {{{"", {7, 3}, {1, 0}}, {"c", {7, 9}, {1, 1}}, {"", {7, 15}, {2, 1}}},
                   {{"", {8, 3}, {0, 2}}}};
  const YarnBuilder builder = builder_of(fabric, {});
  std::vector<std::string> names;
  for (std::size_t i = 0; i < builder.count(); ++i) names.push_back(builder.plan(i)->name);
  const std::vector<std::string> expected = {
      "warp_1_1",      "warp_1_2",      "warp_1_3",      "warp_2_1",      "warp_3_1",
      "warp_3_2",      "warp_3_3",      "layer1_weft_1", "layer1_weft_2", "layer1_weft_3",
      "layer1_weft_4", "layer2_weft_1", "layer2_weft_2", "layer2_weft_3", "layer2_weft_4"};
  EXPECT_EQ(names, expected);
  EXPECT_EQ(plan_of(fabric, "warp_3_2", {}).thread.name, "c");
  // At each weft (points are those of crossings): the warps of the column, and wefts between them.
  const auto heights = [&](const char* name) {
    std::vector<double> made;
    const YarnPlan plan = plan_of(fabric, name, {});
    for (const Vec3& point : plan.points) made.push_back(point.z());
    return made;
  };
  const std::vector<double> low = heights("warp_1_1"), middle = heights("warp_1_2"),
                            high = heights("warp_1_3");
  for (const std::vector<double>* line : {&middle, &high}) ASSERT_EQ(line->size(), low.size());
  for (std::size_t k = 0; k < low.size(); ++k) {
    EXPECT_GT(middle[k] - low[k], 0.25) << k;
    EXPECT_GT(high[k] - middle[k], 0.25) << k;
  }
  // y is at 0.4, 1.2, ...: all warps of a column at one place.
  for (const char* name : {"warp_3_1", "warp_3_2", "warp_3_3"})
    EXPECT_NEAR(plan_of(fabric, name, {}).points.front().y(), 2.0, 1e-12);
}

TEST(Weave, LevelsThatCannotBeAreRefusedAtTheirWarps) {
  const auto refused = [](std::vector<WarpColumn> columns) {
    Fabric fabric = square(0.3, 0.8);
    weave_of(fabric).layers = 2;
    weave_of(fabric).columns = std::move(columns);
    return refusal_of(fabric);
  };
  EXPECT_EQ(refused({{{"", {7, 3}, {1, 3}}}}).place.line, 7);
  EXPECT_EQ(refused({{{"", {7, 3}, {1, 2}}}, {{"", {8, 3}, {1}}}}).place.line, 8);
  EXPECT_EQ(refused({{{"", {7, 3}, {1, 2}}, {"", {7, 9}, {2, 1}}}}).place.column, 9);
  EXPECT_EQ(refused({{{"", {7, 3}, {1, 2}}}, {{"d", {8, 3}, {1, 2}}}}).place.line, 8);
}

TEST(Weave, APolygonLiesAboutItsCentreLineWhereverItsOriginIs) {
  const auto weft = [](const Vec2& origin) {
    yarn::Polygon triangle{{{0.3, -0.1}, {0.0, 0.25}, {-0.3, -0.1}}};
    for (Vec2& corner : triangle.corners) corner += origin;
    Fabric fabric = woven(yarn::Circle{0.3}, 1.0, triangle, 1.2);
    weave_of(fabric).profile = Weave::Profile::straight;
    return body_of(fabric, "layer1_weft_1").surface.points;
  };
  const std::vector<Vec3> here = weft({0.0, 0.0}), there = weft({0.1, -0.07});
  ASSERT_EQ(here.size(), there.size());
  for (std::size_t i = 0; i < here.size(); ++i) EXPECT_LT((here[i] - there[i]).norm(), 1e-9);
}

TEST(Weave, BindersThatCrossInOneGapAreTold) {
  const auto told = [](const Binder& first, const Binder& second) {
    Fabric fabric = woven(yarn::Racetrack{1.2, 0.4}, 2.0, yarn::Racetrack{1.2, 0.4}, 2.4);
    fabric.threads.push_back(thread_of("c", yarn::Racetrack{0.3, 0.1}));
    Weave& weave = weave_of(fabric);
    weave.profile = Weave::Profile::straight;
    weave.layers = 2;
    weave.warp.count = weave.weft.count = 6;
    weave.binders = {first, second};
    Diagnostics diagnostics;
    EXPECT_TRUE(YarnBuilder::create(fabric, {}, diagnostics).has_value());
    std::vector<std::string> texts;
    for (const Message& message : diagnostics.messages())
      texts.push_back(fmt::format("{}: {}", message.place.line, message.text));
    return texts;
  };
  const auto crossing = told({"c", {8, 3}, 1, 1, {3, 0}}, {"c", {9, 3}, 2, 2, {0, 3}});
  ASSERT_EQ(crossing.size(), 1U);
  EXPECT_NE(crossing.front().find("9: in gap 2 lies a binder of line 8"), std::string::npos)
      << crossing.front();
  EXPECT_EQ(told({"c", {8, 3}, 2, 1, {1}}, {"c", {9, 3}, 3, 1, {1}}).size(), 1U) << "one in the other";
  EXPECT_EQ(told({"c", {8, 3}, 2, 1, {3, 0}}, {"c", {9, 3}, 2, 2, {0, 3}}).size(), 0U) << "other gaps";
  EXPECT_EQ(told({"c", {8, 3}, 1, 1, {3, 2}}, {"c", {9, 3}, 1, 1, {1, 0}}).size(), 0U)
      << "one above the other";
  EXPECT_EQ(told({"c", {8, 3}, 3, 3, {3, 0}}, {"c", {9, 3}, 2, 1, {0, 3}}).size(), 1U) << "gap 3";
}

}  // namespace
}  // namespace selvage::fabric
