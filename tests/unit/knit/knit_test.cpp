// The data points and centre lines of weft knits against the published loop.
#include <gtest/gtest.h>

#include <cmath>

#include "construction/build.h"
#include "knit/knit.h"
#include "nurbs/measure.h"

namespace selvage::fabric {
namespace {

constexpr double thread_radius = 0.09;  // of the test's thread

Fabric knitted(Knit knit) {
  Fabric fabric;
  fabric.file = "test.txt";
  Thread thread;
  thread.name = "t";
  thread.diameter = 2 * thread_radius;
  fabric.threads = {thread};
  knit.place = {5, 1};
  knit.threads = {"t"};
  fabric.items = {std::move(knit)};
  return fabric;
}

Knit jersey(int courses, int wales, nurbs::Parameterization method = nurbs::Parameterization::chord) {
  Knit knit;
  knit.courses = courses;
  knit.wales = wales;
  knit.method = method;
  return knit;
}

Knit charted(std::vector<std::string> rows, int courses, int wales) {
  Knit knit = jersey(courses, wales);
  knit.form = Knit::Form::chart;
  knit.chart = std::move(rows);
  return knit;
}

// As published, unless said otherwise.
YarnPlan plan_of(const Fabric& fabric, std::size_t course, bool as_published = true) {
  Diagnostics diagnostics;
  BuildOptions options;
  options.as_published = as_published;
  const Result<std::unique_ptr<Construction>> made =
      make_knit(fabric, std::get<Knit>(fabric.items.front()), options, diagnostics);
  EXPECT_TRUE(made.ok());
  Result<YarnPlan> plan = (*made)->plan(course);
  EXPECT_TRUE(plan.ok());
  tell_from_origin(*plan);
  return std::move(*plan);
}

const std::vector<nurbs::Parameterization> methods = {
    nurbs::Parameterization::uniform, nurbs::Parameterization::chord, nurbs::Parameterization::centripetal};

TEST(Knit, JerseyHasThePublishedNinePoints) {
  const std::vector<Vec3> published = {{-4, -3, -1.5}, {-1, 0, 0},    {-2, 3.5, 1.5},
                                       {-3, 7, 0},     {0, 10, -1.5}, {3, 7, 0},
                                       {2, 3.5, 1.5},  {1, 0, 0},     {4, -3, -1.5}};
  const YarnPlan plan = plan_of(knitted(jersey(3, 5)), 1);
  EXPECT_EQ(plan.name, "course_2");
  EXPECT_EQ(plan.role, Role::course);
  ASSERT_EQ(plan.points.size(), 5U * 8U + 1U);
  for (std::size_t wale = 0; wale < 5; ++wale)
    for (std::size_t i = 0; i < 9; ++i) {
      const Vec3 at = thread_radius * (published[i] + Vec3(8.0 * static_cast<double>(wale) + 4, 7, 0));
      EXPECT_LT((plan.points[8 * wale + i] - at).norm(), 1e-15) << wale << " " << i;
    }
}

TEST(Knit, EveryMethodMeetsTheDataPoints) {
  for (const nurbs::Parameterization method : methods) {
    Knit knit = charted({"KPTM", "KKPP", "TKKP", "PKKK"}, 6, 40);
    knit.method = method;
    for (const Knit& each : {jersey(2, 60, method), knit}) {
      const YarnPlan plan = plan_of(knitted(each), 1);
      ASSERT_EQ(plan.line.parameters.size(), plan.points.size());
      const double size = (plan.points.back() - plan.points.front()).norm();
      for (std::size_t i = 0; i < plan.points.size(); ++i)
        EXPECT_LT((nurbs::evaluate(plan.line.curve, plan.line.parameters[i]) - plan.points[i]).norm(),
                  1e-12 * size);
    }
  }
}

// The figures are those of the periodic cubic through the nine points. The ends of a course are mirror
// planes, so that every loop of a jersey has this length, the first and the last one too.
TEST(Knit, EveryLoopOfAJerseyHasTheLengthOfThePeriodicOne) {
  const std::vector<double> published = {35.513, 35.528, 35.510};
  constexpr std::size_t wales = 30;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const YarnPlan plan = plan_of(knitted(jersey(1, wales, methods[m])), 0);
    const std::vector<double>& t = plan.line.parameters;
    const double inner = nurbs::arc_length(plan.line.curve, t[8 * 15], t[8 * 16]);
    EXPECT_NEAR(inner / thread_radius, published[m], 0.01);
    for (std::size_t wale = 0; wale < wales; ++wale)
      EXPECT_NEAR(nurbs::arc_length(plan.line.curve, t[8 * wale], t[8 * wale + 8]), inner,
                  1e-9 * thread_radius)
          << wale;
  }
}

TEST(Knit, LoopsHaveThePublishedSize) {
  const YarnPlan plan = plan_of(knitted(jersey(2, 5)), 0);
  const YarnPlan next = plan_of(knitted(jersey(2, 5)), 1);
  Box3 box;
  const std::vector<double>& t = plan.line.parameters;
  for (int i = 0; i <= 2000; ++i)
    box.extend(nurbs::evaluate(plan.line.curve, t[16] + (t[24] - t[16]) * i / 2000));
  EXPECT_NEAR(box.sizes().x(), 8 * thread_radius, 1e-12);
  EXPECT_NEAR(box.sizes().y() + 2 * thread_radius, 15 * thread_radius, 1e-6 * thread_radius);
  EXPECT_NEAR(box.sizes().z() + 2 * thread_radius, 5 * thread_radius, 1e-6 * thread_radius);
  EXPECT_NEAR(next.points[0].y() - plan.points[0].y(), 7 * thread_radius, 1e-15);
}

TEST(Knit, CoursesEndInPlanes) {
  for (const Knit& knit : {jersey(1, 3), charted({"TK", "KP", "KM"}, 3, 5)}) {
    const Fabric fabric = knitted(knit);
    Diagnostics diagnostics;
    const std::optional<YarnBuilder> builder = YarnBuilder::create(fabric, {}, diagnostics);
    ASSERT_TRUE(builder);
    for (std::size_t i = 0; i < builder->count(); ++i) {
      const Result<yarn::Body> body = builder->build(i);
      ASSERT_TRUE(body.ok());
      const nurbs::Surface& surface = body->surface;
      for (int u = 0; u < surface.count_u; ++u) {
        EXPECT_NEAR(surface.point(u, 0).x(), 0, 1e-14);
        EXPECT_NEAR(surface.point(u, surface.count_v - 1).x(), knit.wales * 8 * thread_radius, 1e-13);
      }
    }
  }
}

// Course i + repeat is course i moved: each coordinate is base + i * pitch with one rounding.
TEST(Knit, RepeatsAreTheSameToTheLastBit) {
  const Fabric fabric = knitted(charted({"KK", "KT", "KK", "TP"}, 20, 9));
  const YarnPlan base = plan_of(knitted(charted({"KK", "KT", "KK", "TP"}, 20, 9)), 4);
  const YarnPlan first = plan_of(fabric, 8), second = plan_of(fabric, 12);
  ASSERT_EQ(first.points.size(), second.points.size());
  ASSERT_EQ(first.points.size(), base.points.size());
  for (std::size_t i = 0; i < first.points.size(); ++i) {
    EXPECT_EQ(first.points[i].x(), second.points[i].x());
    EXPECT_EQ(first.points[i].z(), second.points[i].z());
    EXPECT_NEAR(second.points[i].y() - first.points[i].y(), 28 * thread_radius, 1e-14);
    EXPECT_NEAR(first.points[i].y() - base.points[i].y(), 28 * thread_radius, 1e-14);
  }
  // In units in which the data are whole numbers the one rounding is exact: nothing may differ at all.
  Fabric whole = fabric;
  whole.threads.front().diameter = 2;
  const YarnPlan low = plan_of(knitted(jersey(3, 4)), 0);
  whole.items = {jersey(1000, 1000)};
  std::get<Knit>(whole.items.front()).threads = {"t"};
  const YarnPlan far = plan_of(whole, 999);
  for (std::size_t i = 0; i + 8 < far.points.size(); ++i)
    EXPECT_EQ(far.points[i + 8], far.points[i] + Vec3(8, 0, 0)) << i;
  EXPECT_EQ(far.points.front(), Vec3(0, 999 * 7 - 3, -1.5));
}

// What the moves make of a loop of the plain stitch: the same in a cloth of a million loops at once.
TEST(Knit, LoopsThatAreMovedApartRepeatToTheLastBit) {
  const Fabric fabric = knitted(jersey(1000, 1000));
  const YarnPlan low = plan_of(fabric, 10, false), high = plan_of(fabric, 990, false);
  const YarnPlan small = plan_of(knitted(jersey(40, 30)), 10, false);
  ASSERT_EQ(low.points.size(), 8001U);
  for (std::size_t i = 0; i < low.points.size(); ++i) {
    EXPECT_EQ(low.points[i].x(), high.points[i].x());
    EXPECT_EQ(low.points[i].z(), high.points[i].z());
    EXPECT_NEAR(high.points[i].y() - low.points[i].y(), 980 * 7 * thread_radius, 1e-12);
    if (i < 120) {
      EXPECT_EQ(low.points[i], small.points[i]);
    }
    if (i < 24 || i + 32 > low.points.size()) continue;
    EXPECT_EQ(low.points[i].z(), low.points[i + 8].z());
    EXPECT_EQ(low.points[i].y(), low.points[i + 8].y());
    EXPECT_NEAR(low.points[i + 8].x() - low.points[i].x(), 8 * thread_radius, 1e-12);
  }
}

// A loop is changed by little.
TEST(Knit, LoopsThatAreMovedApartStayLoops) {
  for (const nurbs::Parameterization method : methods) {
    const YarnPlan raw = plan_of(knitted(jersey(30, 30, method)), 15);
    const YarnPlan moved = plan_of(knitted(jersey(30, 30, method)), 15, false);
    for (std::size_t i = 0; i < raw.points.size(); ++i)
      EXPECT_LT((moved.points[i] - raw.points[i]).norm(), 0.9 * thread_radius);
    EXPECT_EQ(moved.points.front().x(), raw.points.front().x());
    EXPECT_EQ(moved.points.back().x(), raw.points.back().x());
    EXPECT_NEAR(nurbs::arc_length(moved.line.curve) / nurbs::arc_length(raw.line.curve), 1, 0.04);
  }
}

// A small cloth is its own mirror image as before. (In a large one loops that all are alike and symmetric
// have no room: each leans to one side, all to the same.)
TEST(Knit, SmallClothsStaySymmetric) {
  for (const nurbs::Parameterization method : methods) {
    const std::vector<Vec3> points = plan_of(knitted(jersey(6, 6, method)), 2, false).points;
    const double both = points.front().x() + points.back().x();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3& other = points[points.size() - 1 - i];
      EXPECT_LT((points[i] - Vec3(both - other.x(), other.y(), other.z())).norm(), 1e-9 * thread_radius) << i;
    }
  }
}

TEST(Knit, ARepeatThatIsTooLargeToBeMovedApartSaysSo) {
  std::vector<std::string> rows(120, std::string(120, 'K'));
  rows[5][7] = 'P';
  const Fabric fabric = knitted(charted(rows, 300, 300));
  Diagnostics diagnostics;
  EXPECT_TRUE(YarnBuilder::create(fabric, {}, diagnostics));
  ASSERT_EQ(diagnostics.messages().size(), 1U);
  EXPECT_NE(diagnostics.messages().front().text.find("as published"), std::string::npos);
  BuildOptions raw;
  raw.as_published = true;
  Diagnostics none;
  EXPECT_TRUE(YarnBuilder::create(fabric, raw, none));
  EXPECT_TRUE(none.messages().empty());
}

// Width and thickness scale the loop each in its own direction.
TEST(Knit, FlatYarnsMakeFlatLoops) {
  Fabric fabric = knitted(jersey(1, 2));
  fabric.threads.front().section = yarn::Ellipse{0.4, 0.1};
  const YarnPlan plan = plan_of(fabric, 0);
  EXPECT_NEAR(plan.points[4].x(), 4 * 0.2, 1e-15);
  EXPECT_NEAR(plan.points[4].y(), 10 * 0.2, 1e-15);
  EXPECT_NEAR(plan.points[4].z(), -1.5 * 0.05, 1e-15);
}

// With a unit cell the cloth goes on: the courses inside are those of an endless cloth.
TEST(Knit, ACellIsFilledByAClothThatGoesOnBeyondIt) {
  Fabric fabric = knitted(charted({"KT", "KK"}, 4, 4));
  fabric.cell = Cell{};
  Diagnostics diagnostics;
  const std::optional<YarnBuilder> builder = YarnBuilder::create(fabric, {}, diagnostics);
  ASSERT_TRUE(builder);
  Result<YarnPlan> lower = error(Kind::geometry, ""), upper = lower;
  double low = 1e9, high = -1e9;
  for (std::size_t i = 0; i < builder->count(); ++i) {
    Result<YarnPlan> plan = builder->plan(i);
    ASSERT_TRUE(plan.ok());
    low = std::min(low, plan->points.front().y());
    high = std::max(high, plan->points.front().y());
    EXPECT_LE(plan->points.front().x(), -8 * thread_radius);
    EXPECT_GE(plan->points.back().x(), 5 * 8 * thread_radius);
    if (plan->name == "course_1") lower = plan;
    if (plan->name == "course_3") upper = plan;
  }
  EXPECT_LE(low, -2 * 7 * thread_radius);
  EXPECT_GE(high, 5 * 7 * thread_radius);
  ASSERT_TRUE(lower.ok() && upper.ok());
  const auto at = [](const YarnPlan& plan, double x) {  // where the course crosses a plane between wales
    double from = 0, to = 1;
    for (int i = 0; i < 200; ++i) {
      const double middle = 0.5 * (from + to);
      (nurbs::evaluate(plan.line.curve, middle).x() < x ? from : to) = middle;
    }
    return nurbs::evaluate_jet(plan.line.curve, from);
  };
  // Periodic along a course (two wales), and from course to course (two courses).
  const nurbs::CurveJet left = at(*lower, 0), right = at(*lower, 32 * thread_radius), over = at(*upper, 0);
  EXPECT_LT((right.position - left.position - Vec3(32 * thread_radius, 0, 0)).norm(), 1e-13);
  EXPECT_LT((right.d1.normalized() - left.d1.normalized()).norm(), 1e-12);
  EXPECT_LT((over.position - left.position - Vec3(0, 14 * thread_radius, 0)).norm(), 1e-13);
}

std::optional<Message> refusal(const Knit& knit) {
  const Fabric fabric = knitted(knit);
  Diagnostics diagnostics;
  if (YarnBuilder::create(fabric, {}, diagnostics)) return std::nullopt;
  return *diagnostics.first_error();
}

TEST(Knit, RefusesWhatIsTooLargeBeforeBuildingIt) {
  for (const auto& [courses, wales] : {std::pair{31623, 31623}, {1, 2147483647}, {2147483647, 2147483647}}) {
    const std::optional<Message> message = refusal(jersey(courses, wales));
    ASSERT_TRUE(message);
    EXPECT_EQ(message->kind, Kind::limit);
    EXPECT_EQ(message->place.line, 5);
    EXPECT_NE(message->text.find("data points"), std::string::npos) << message->text;
  }
  EXPECT_NE(refusal(jersey(31623, 31623))->text.find("8e+09"), std::string::npos);
}

TEST(Knit, RefusesLoopsThatAreHeldForTooLong) {
  Knit knit = charted({"KK", "KT", "KM", "KT", "KM", "KT", "KM", "KK"}, 8, 2);
  EXPECT_FALSE(refusal(knit));  // six
  knit.chart.insert(knit.chart.begin() + 1, "KT");
  knit.chart_lines = {11, 12, 13, 14, 15, 16, 17, 18, 19};
  const std::optional<Message> message = refusal(knit);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->place.line, 12);
  EXPECT_NE(message->text.find("wale 2 of the chart has more than 6"), std::string::npos) << message->text;
  EXPECT_TRUE(refusal(charted({"KM"}, 8, 2)));  // never knitted off
}

}  // namespace
}  // namespace selvage::fabric
