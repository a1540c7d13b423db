// Weft knits of given densities and loop length: what was asked for is measured on the built centre lines.
#include <gtest/gtest.h>

#include <cmath>

#include "construction/build.h"
#include "knit/knit.h"
#include "nurbs/measure.h"

namespace selvage::fabric {
namespace {

Fabric fabric_of(Knit knit, double tex = 20, double packing = 0.6) {
  Fabric fabric;
  fabric.file = "test.txt";
  Thread thread;
  thread.name = "t";
  thread.linear_density = LinearDensity{tex, LinearDensity::Measure::tex};
  thread.density = 1.52;
  thread.packing = packing;
  fabric.threads = {thread};
  knit.place = {5, 1};
  knit.threads = {"t"};
  fabric.items = {std::move(knit)};
  return fabric;
}

// 18 courses and 13 wales a cm.
Knit jersey(double loop) {
  Knit knit;
  knit.courses = 8;
  knit.wales = 10;
  knit.course_pitch = 10.0 / 18;
  knit.wale_pitch = 10.0 / 13;
  knit.loop = loop;
  return knit;
}

Knit charted(std::vector<std::string> rows, double loop) {
  Knit knit = jersey(loop);
  knit.form = Knit::Form::chart;
  knit.chart = std::move(rows);
  return knit;
}

struct BuiltKnit {
  std::vector<YarnPlan> plans;
  Diagnostics diagnostics;
};

BuiltKnit built(const Fabric& fabric, bool as_published = false) {
  BuiltKnit all;
  BuildOptions options;
  options.as_published = as_published;
  const Result<std::unique_ptr<Construction>> made =
      make_knit(fabric, std::get<Knit>(fabric.items.front()), options, all.diagnostics);
  if (!made) {
    all.diagnostics.add(made.error());
    return all;
  }
  for (std::size_t i = 0; i < (*made)->count(); ++i) {
    Result<YarnPlan> plan = (*made)->plan(i);
    EXPECT_TRUE(plan.ok());
    tell_from_origin(*plan);
    all.plans.push_back(std::move(*plan));
  }
  return all;
}

std::string first_error_of(const Fabric& fabric) {
  const BuiltKnit all = built(fabric);
  return all.diagnostics.first_error() != nullptr ? all.diagnostics.first_error()->text : "";
}

// Where a course's sinkers are lowest, by its height: the same place of every loop.
double lowest(const YarnPlan& plan, double from, double to) {
  double y = 1e9;
  const std::vector<double>& t = plan.line.parameters;
  for (int i = 0; i <= 20000; ++i) {
    const Vec3 p = nurbs::evaluate(plan.line.curve, t.front() + (t.back() - t.front()) * i / 20000);
    if (p.x() >= from && p.x() <= to) y = std::min(y, p.y());
  }
  return y;
}

TEST(KnitDensity, JerseyHasTheDensitiesAndTheLoopThatItIsGiven) {
  for (const double loop : {2.8, 3.1, 3.6}) {
    const BuiltKnit all = built(fabric_of(jersey(loop)));
    ASSERT_EQ(all.plans.size(), 8U) << loop;
    const YarnPlan &low = all.plans[2], &high = all.plans[6];
    EXPECT_NEAR(nurbs::arc_length(low.line.curve) / 10, loop, 1e-3 * loop);
    // Wales a cm by the course's two ends, courses a cm by how far four courses rise.
    const Vec3 first = low.points.front(), last = low.points.back();
    EXPECT_NEAR(10 * 10.0 / (last.x() - first.x()), 13, 1e-9);
    const double rise = lowest(high, 3, 5) - lowest(low, 3, 5);
    EXPECT_NEAR(10 * 4 / rise, 18, 0.002 * 18);
  }
}

// As published: the length is met exactly, in every loop.
TEST(KnitDensity, TheLengthIsMetBeforeLoopsAreMovedApart) {
  for (const nurbs::Parameterization how : {nurbs::Parameterization::chord, nurbs::Parameterization::uniform,
                                            nurbs::Parameterization::centripetal}) {
    Knit knit = jersey(2.8);
    knit.method = how;
    const BuiltKnit all = built(fabric_of(knit), true);
    ASSERT_EQ(all.plans.size(), 8U);
    EXPECT_NEAR(nurbs::arc_length(all.plans[3].line.curve) / 10, 2.8, 1e-6);
  }
}

// The mean of all stitches, a tuck being one, a miss none.
TEST(KnitDensity, EveryChartHasTheLengthThatItIsGiven) {
  Knit rib = jersey(3.2);
  rib.form = Knit::Form::rib;
  rib.rib_a = rib.rib_b = 1;
  Knit purl = jersey(3.2);
  purl.form = Knit::Form::purl;
  for (const auto& [knit, stitches] : {std::pair(rib, 1.0),
                                       {purl, 1.0},
                                       {charted({"KT", "KK"}, 3.2), 1.0},
                                       {charted({"KM", "KK", "MK", "KK"}, 3.4), 0.75}}) {
    Knit large = knit;
    large.courses = 16;
    large.wales = 24;
    const BuiltKnit all = built(fabric_of(large, 8));
    ASSERT_EQ(all.plans.size(), 16U) << first_error_of(fabric_of(large, 8));
    double length = 0;
    for (std::size_t i = 4; i < 12; ++i) length += nurbs::arc_length(all.plans[i].line.curve);
    EXPECT_NEAR(length / (8 * 24 * stitches), *large.loop, 0.01 * *large.loop);
  }
}

TEST(KnitDensity, YarnsOfAGivenDensityStayApart) {
  for (const double tex : {5.0, 12.0, 20.0}) {
    const Fabric fabric = fabric_of(jersey(2.8), tex);
    const BuiltKnit all = built(fabric);
    const double diameter = 2 * std::sqrt(tex / (1000 * std::acos(-1.0) * 1.52 * 0.6));
    double nearest = 1e9;
    const auto sampled = [](const YarnPlan& plan) {
      std::vector<Vec3> points;
      for (int i = 0; i <= 2000; ++i)
        points.push_back(nurbs::evaluate(
            plan.line.curve, plan.line.parameters.front() +
                                 (plan.line.parameters.back() - plan.line.parameters.front()) * i / 2000));
      return points;
    };
    const std::vector<Vec3> a = sampled(all.plans[3]), b = sampled(all.plans[4]);
    for (const Vec3& p : a)
      for (const Vec3& q : b) nearest = std::min(nearest, (p - q).norm());
    EXPECT_GT(nearest, diameter) << tex;
    EXPECT_LT(nearest, 1.5 * diameter) << tex;  // they hold each other
  }
}

TEST(KnitDensity, RefusesLoopsThatCannotBe) {
  const std::string too_short = first_error_of(fabric_of(jersey(2.2)));
  EXPECT_NE(too_short.find("too short"), std::string::npos) << too_short;
  const std::string too_long = first_error_of(fabric_of(jersey(6)));
  EXPECT_NE(too_long.find("too long"), std::string::npos) << too_long;
  // The remedies work.
  for (const std::string& text : {too_short, too_long}) {
    const bool is_short = &text != &too_long && text == too_short;
    double courses = 0, wales = 0, bound = 0, thick = 0;
    ASSERT_EQ(std::sscanf(text.c_str() + text.find(" have ") + 6, "%lf", &bound), 1) << text;
    ASSERT_EQ(std::sscanf(text.c_str() + text.find("with courses"), "with courses %lf and wales %lf",
                          &courses, &wales),
              2)
        << text;
    ASSERT_EQ(std::sscanf(text.c_str() + text.find("with a yarn of"), "with a yarn of %lf", &thick), 1)
        << text;
    Knit knit = jersey(bound * (is_short ? 1.001 : 0.999));
    EXPECT_EQ(built(fabric_of(knit), true).plans.size(), 8U) << text;
    knit = jersey(is_short ? 2.2 : 6);
    knit.course_pitch = courses * (is_short ? 0.99 : 1.01);
    knit.wale_pitch = wales * (is_short ? 0.99 : 1.01);
    EXPECT_EQ(built(fabric_of(knit), true).plans.size(), 8U) << text;
  }
}

TEST(KnitDensity, YarnsThatAreTooThickAreRefusedWithWhatFits) {
  Knit knit = jersey(3.2);
  Fabric fabric = fabric_of(knit, 50);
  const std::string text = first_error_of(fabric);
  double thick = 0;
  ASSERT_EQ(std::sscanf(text.c_str() + text.find("a yarn of", text.find(':')), "a yarn of %lf", &thick), 1)
      << text;
  fabric.threads.front().diameter = thick;
  EXPECT_EQ(first_error_of(fabric), "");
}

TEST(KnitDensity, PitchesThatNoLoopHasAreRefused) {
  Knit knit = jersey(3);
  knit.loop.reset();
  knit.wale_pitch = 0.33;
  EXPECT_NE(first_error_of(fabric_of(knit)).find("wale pitch of 0.33"), std::string::npos);
  knit.wale_pitch = 0.8;
  knit.course_pitch = 0.16;
  EXPECT_NE(first_error_of(fabric_of(knit)).find("course pitch of 0.16"), std::string::npos);
}

TEST(KnitDensity, AClothFarFromMundensConstantsIsToldSo) {
  EXPECT_TRUE(built(fabric_of(jersey(2.8))).diagnostics.messages().empty());
  Knit open = jersey(4);
  const BuiltKnit all = built(fabric_of(open, 8));
  ASSERT_EQ(all.diagnostics.messages().size(), 1U);
  EXPECT_NE(all.diagnostics.messages().front().text.find("7.2 courses and 5.2 wales"), std::string::npos)
      << all.diagnostics.messages().front().text;
}

}  // namespace
}  // namespace selvage::fabric
