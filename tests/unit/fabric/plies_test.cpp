// Plies and filaments against what is known without them: the helix formula, published packings, distances of
// the built centre lines.
#include "fabric/plies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "construction/build.h"
#include "fabric/clearance.h"
#include "fabric/disc_packing.h"
#include "nurbs/measure.h"

namespace selvage::fabric {

namespace {

using std::numbers::pi;

// A yarn through these points; with no more statements a straight or bent single yarn of diameter 1.
Fabric fabric_with(Thread thread, std::vector<Vec3> points) {
  Fabric fabric;
  thread.name = "t";
  if (!thread.diameter && !thread.section) thread.diameter = 1.0;
  fabric.threads.push_back(thread);
  Yarn yarn;
  yarn.name = "y";
  yarn.thread = "t";
  Path path;
  path.points = std::move(points);
  yarn.shape = path;
  fabric.items.emplace_back(yarn);
  return fabric;
}

const std::vector<Vec3> straight_line = {{0, 0, 0}, {20, 0, 0}};
const std::vector<Vec3> bent = {{0, 0, 0}, {4, 1, 0}, {8, 0, 1}, {12, -1, 0}, {16, 0, 0}};

std::vector<YarnPlan> plans_of(const Fabric& fabric, Detail detail = Detail::filaments) {
  BuildOptions options;
  options.detail = detail;
  Diagnostics diagnostics;
  const std::optional<YarnBuilder> builder = YarnBuilder::create(fabric, options, diagnostics);
  std::vector<YarnPlan> plans;
  if (!builder) {
    ADD_FAILURE() << (diagnostics.first_error() != nullptr ? to_string(*diagnostics.first_error()) : "?");
    return plans;
  }
  for (std::size_t i = 0; i < builder->count(); ++i) {
    Result<YarnPlan> plan = builder->plan(i);
    if (plan.ok())
      plans.push_back(std::move(*plan));
    else
      ADD_FAILURE() << to_string(plan.error());
  }
  return plans;
}

std::string error_of(const Fabric& fabric, Detail detail = Detail::usual) {
  BuildOptions options;
  options.detail = detail;
  Diagnostics diagnostics;
  const std::optional<YarnBuilder> builder = YarnBuilder::create(fabric, options, diagnostics);
  if (!builder) return diagnostics.first_error() != nullptr ? to_string(*diagnostics.first_error()) : "?";
  const Result<YarnPlan> plan = builder->plan(0);
  return plan.ok() ? "" : to_string(plan.error());
}

double diameter_of(const YarnPlan& plan) {
  return std::get<yarn::Circle>(plan.spec.section).diameter;
}

std::vector<Vec3> sampled(const YarnPlan& plan, int looks) {
  std::vector<Vec3> points;
  for (int i = 0; i <= looks; ++i)
    points.push_back(nurbs::evaluate(plan.line.curve, static_cast<double>(i) / looks));
  return points;
}

// The least distance of two centre lines, sampled densely, between segments' ends and segments.
double distance_between(const std::vector<Vec3>& a, const std::vector<Vec3>& b, std::size_t window) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::size_t from = i > window ? i - window : 0, to = std::min(b.size() - 1, i + window);
    for (std::size_t j = from; j < to; ++j) {
      const Vec3 edge = b[j + 1] - b[j], to_point = a[i] - b[j];
      const double f = std::clamp(to_point.dot(edge) / edge.squaredNorm(), 0.0, 1.0);
      least = std::min(least, (to_point - f * edge).norm());
    }
  }
  return least;
}

// The least of (distance / mean diameter) over all pairs.
double least_clearance(const std::vector<YarnPlan>& plans, int looks = 600) {
  std::vector<std::vector<Vec3>> lines;
  for (const YarnPlan& plan : plans) lines.push_back(sampled(plan, looks));
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < plans.size(); ++i)
    for (std::size_t j = i + 1; j < plans.size(); ++j)
      least = std::min(least, distance_between(lines[i], lines[j], static_cast<std::size_t>(looks) / 8) /
                                  (0.5 * (diameter_of(plans[i]) + diameter_of(plans[j]))));
  return least;
}

// Turns about the x axis, right-handed positive.
double turns_about_x(const YarnPlan& plan) {
  double angle = 0.0;
  const std::vector<Vec3> points = sampled(plan, 2000);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vec2 a = points[i - 1].tail<2>(), b = points[i].tail<2>();
    angle += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  }
  return angle / (2.0 * pi);
}

Thread ply_thread(int count, double turns, Hand hand) {
  Thread thread;
  thread.plies = Plies{count, turns, hand};
  return thread;
}
Thread filament_thread(int count, std::optional<double> packing, double turns = 0.0) {
  Thread thread;
  thread.filaments = count;
  thread.packing = packing;
  if (turns > 0.0) thread.twist = Twist{turns, Hand::z, false};
  return thread;
}

double share(const std::vector<YarnPlan>& plans) {
  double sum = 0.0;
  for (const YarnPlan& plan : plans) sum += diameter_of(plan) * diameter_of(plan);
  return sum;  // of a section of diameter 1
}

}  // namespace

TEST(DiscPacking, MeetsThePublishedRadii) {
  // Radius of the circle over that of the discs; Graham, Lubachevsky, Nurmela, Oestergard 1998.
  const std::vector<std::pair<std::size_t, double>> published = {
      {1, 1.0},       {2, 2.0},       {3, 2.154701},  {4, 2.414214},  {5, 2.701302},
      {6, 3.0},       {7, 3.0},       {8, 3.304765},  {9, 3.613126},  {10, 3.813026},
      {11, 3.923804}, {12, 4.029602}, {13, 4.236068}, {14, 4.328429}, {15, 4.521357},
      {16, 4.615426}, {17, 4.792034}, {18, 4.863703}, {19, 4.863703}, {20, 5.122321}};
  for (const auto& [n, ratio] : published) {
    const double ours = 1.0 / discs_in_circle(n).radius;
    EXPECT_GT(ours, ratio * (1.0 - 1e-6)) << n;
    EXPECT_LT(ours, ratio * 1.005) << n;
  }
  EXPECT_NEAR(3.0 * std::pow(discs_in_circle(3).radius, 2), 0.646, 5e-4);
  EXPECT_NEAR(7.0 * std::pow(discs_in_circle(7).radius, 2), 0.778, 5e-4);
}

TEST(DiscPacking, DiscsNeitherOverlapNorLeaveTheCircle) {
  for (const std::size_t n : {2U, 5U, 13U, 29U, 31U, 48U, 1000U}) {
    const DiscPacking packing = discs_in_circle(n);
    ASSERT_EQ(packing.centres.size(), n);
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_LE(packing.centres[i].norm() + packing.radius, 1.0 + 1e-12);
      for (std::size_t j = i + 1; j < n; ++j)
        ASSERT_GE((packing.centres[j] - packing.centres[i]).norm(), 2.0 * packing.radius * (1.0 - 1e-12));
    }
  }
}

TEST(DiscPacking, FillsOtherSections) {
  const std::vector<Vec2> outline = outline_polygon(yarn::Racetrack{4.0, 1.0});
  for (const std::size_t n : {3U, 10U, 40U, 200U}) {
    const DiscPacking packing = discs_in_polygon(n, outline);
    ASSERT_EQ(packing.centres.size(), n);
    EXPECT_GT(static_cast<double>(n) * pi * std::pow(packing.radius, 2), 0.5 * (3.0 + pi / 4.0)) << n;
    for (std::size_t i = 0; i < n; ++i) {
      // Inside a racetrack: nearer than 1/2 to its middle line.
      const Vec2& c = packing.centres[i];
      const double from_middle = std::hypot(std::max(std::abs(c.x()) - 1.5, 0.0), c.y());
      EXPECT_LE(from_middle + packing.radius, 0.5 + 1e-3);
      for (std::size_t j = i + 1; j < n; ++j)
        ASSERT_GE((packing.centres[j] - c).norm(), 2.0 * packing.radius * (1.0 - 1e-9));
    }
  }
}

TEST(Plies, LengthIsTheHelixs) {
  for (const int count : {2, 3, 4, 7}) {
    const double turns = 120.0;  // per metre
    for (const YarnPlan& plan : plans_of(fabric_with(ply_thread(count, turns, Hand::z), straight_line))) {
      const double radius = nurbs::evaluate(plan.line.curve, 0.0).tail<2>().norm();
      const double formula = 20.0 * std::sqrt(1.0 + std::pow(2.0 * pi * radius * turns / 1000.0, 2));
      EXPECT_NEAR(nurbs::arc_length(plan.line.curve), formula, 1e-4 * formula) << count;
      // The plies' discs fill the yarn's: the outermost touch its circle.
      if (radius > 1e-9) {
        EXPECT_NEAR(radius + 0.5 * diameter_of(plan), 0.5, 1e-9);
      }
      for (const Vec3& p : sampled(plan, 500))
        EXPECT_NEAR(p.tail<2>().norm(), radius, 1e-4 * diameter_of(plan));
    }
  }
}

TEST(Plies, ZTurnsRightAndSLeft) {
  const std::vector<YarnPlan> z = plans_of(fabric_with(ply_thread(3, 120.0, Hand::z), straight_line));
  const std::vector<YarnPlan> s = plans_of(fabric_with(ply_thread(3, 120.0, Hand::s), straight_line));
  ASSERT_EQ(z.size(), 3U);
  ASSERT_EQ(s.size(), 3U);
  // A right-handed helix along x turns from y to z; 0.12 turns per mm over 20 mm.
  for (const YarnPlan& plan : z) EXPECT_NEAR(turns_about_x(plan), 2.4, 1e-6);
  for (const YarnPlan& plan : s) EXPECT_NEAR(turns_about_x(plan), -2.4, 1e-6);
}

TEST(Plies, UnitsOfTheFileHold) {
  Fabric metres = fabric_with(ply_thread(2, 120.0, Hand::z), {{0, 0, 0}, {0.02, 0, 0}});
  metres.units = Unit::m;
  metres.threads[0].diameter = 0.001;
  const std::vector<YarnPlan> plans = plans_of(metres);
  ASSERT_EQ(plans.size(), 2U);
  EXPECT_NEAR(turns_about_x(plans[0]), 2.4, 1e-6);
}

TEST(Plies, NamesAndGroups) {
  Thread thread = ply_thread(2, 100.0, Hand::s);
  thread.filaments = 3;
  const Fabric fabric = fabric_with(thread, straight_line);
  std::vector<std::string> names;
  for (const YarnPlan& plan : plans_of(fabric)) {
    names.push_back(plan.name);
    EXPECT_EQ(plan.group, "y");
  }
  EXPECT_EQ(names, (std::vector<std::string>{"y.ply1.f1", "y.ply1.f2", "y.ply1.f3", "y.ply2.f1", "y.ply2.f2",
                                             "y.ply2.f3"}));
  const std::vector<YarnPlan> plies = plans_of(fabric, Detail::plies);
  ASSERT_EQ(plies.size(), 2U);
  EXPECT_EQ(plies[1].name, "y.ply2");
  const std::vector<YarnPlan> yarns = plans_of(fabric, Detail::yarn);
  ASSERT_EQ(yarns.size(), 1U);
  EXPECT_EQ(yarns[0].name, "y");
  EXPECT_EQ(yarns[0].group, "");
}

TEST(Filaments, FillThePackingOrTheLargestShareThatDiscsAdmit) {
  for (const auto& [count, packing] :
       {std::pair{48, 0.6}, {48, 0.7}, {7, 0.5}, {19, 0.78}, {300, 0.75}, {1000, 0.8}})
    EXPECT_NEAR(share(plans_of(fabric_with(filament_thread(count, packing), straight_line))), packing,
                0.02 * packing)
        << count;
  // Untwisted, 0.5 % of the diameter left free: (1 - 0.005)^2 of the published 0.646 and 0.778.
  for (const auto& [count, largest] : {std::pair{3, 0.646}, {7, 0.778}}) {
    const std::vector<YarnPlan> plans = plans_of(fabric_with(filament_thread(count, 0.9), straight_line));
    EXPECT_NEAR(share(plans), largest * 0.995 * 0.995, 1e-3 * largest) << count;
    ASSERT_EQ(plans[0].messages.size(), 1U);
    EXPECT_NE(plans[0].messages[0].text.find(count == 3 ? "0.640" : "0.770"), std::string::npos)
        << plans[0].messages[0].text;
    for (std::size_t i = 1; i < plans.size(); ++i) EXPECT_TRUE(plans[i].messages.empty());
  }
  EXPECT_TRUE(plans_of(fabric_with(filament_thread(7, 0.7), straight_line))[0].messages.empty());
}

TEST(Filaments, DoNotOverlapStraightTwistedOrBent) {
  for (const int count : {3, 7, 19, 48})
    for (const double turns : {0.0, 100.0, 250.0})
      for (const std::vector<Vec3>& path : {straight_line, bent}) {
        const std::vector<YarnPlan> plans = plans_of(fabric_with(filament_thread(count, 0.9, turns), path));
        ASSERT_EQ(plans.size(), static_cast<std::size_t>(count));
        // What is left free is 1 % at most where nothing bends; nothing is lost to the inclination.
        const double clearance = least_clearance(plans);
        EXPECT_GE(clearance, 1.0 + 1e-3) << count << " filaments, " << turns << " turns";
        if (path == straight_line) {
          EXPECT_LE(clearance, 1.011) << count << " filaments, " << turns << " turns";
        }
      }
}

TEST(Filaments, OfTheCrossSectionAloneWouldOverlapWhenTwisted) {
  // The same discs, twisted without regard to the inclination, come nearer to each other than their diameter:
  // the shrinking is needed.
  const double at_rest = diameter_of(plans_of(fabric_with(filament_thread(19, 0.9), straight_line))[0]);
  const std::vector<YarnPlan> twisted = plans_of(fabric_with(filament_thread(19, 0.9, 250.0), straight_line));
  EXPECT_LT(diameter_of(twisted[0]), 0.97 * at_rest);
}

TEST(Filaments, CabledYarnsDoNotOverlap) {
  Thread thread = ply_thread(3, 100.0, Hand::z);
  thread.filaments = 7;
  thread.twist = Twist{200.0, Hand::s, false};
  for (const std::vector<Vec3>& path : {straight_line, bent}) {
    const std::vector<YarnPlan> plans = plans_of(fabric_with(thread, path));
    ASSERT_EQ(plans.size(), 21U);
    EXPECT_GE(least_clearance(plans), 1.0 + 1e-3);
  }
}

TEST(Filaments, RingsClose) {
  Thread thread = filament_thread(7, 0.7, 60.0);
  Fabric fabric = fabric_with(thread, {{5, 0, 0}, {0, 5, 0}, {-5, 0, 0}, {0, -5, 0}});
  std::get<Yarn>(fabric.items[0]).closed = true;
  const std::vector<YarnPlan> plans = plans_of(fabric);
  for (const YarnPlan& plan : plans) {
    EXPECT_TRUE(plan.line.closed);
    EXPECT_EQ(plan.line.curve.points.front(), plan.line.curve.points.back());
  }
  EXPECT_GE(least_clearance(plans), 1.0 + 1e-3);
}

TEST(Filaments, OneThousand) {
  const std::vector<YarnPlan> plans = plans_of(fabric_with(filament_thread(1000, 0.75, 50.0), straight_line));
  ASSERT_EQ(plans.size(), 1000U);
  EXPECT_NEAR(share(plans), 0.75, 0.02 * 0.75);
}

TEST(Plies, WhatCannotBe) {
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  // 45 degrees at the outside: 2 pi 0.5 n = 1 at n = 318 turns per metre.
  EXPECT_TRUE(has(error_of(fabric_with(ply_thread(3, 330.0, Hand::z), straight_line)), "at most 311 turns"))
      << error_of(fabric_with(ply_thread(3, 330.0, Hand::z), straight_line));
  EXPECT_EQ(error_of(fabric_with(ply_thread(3, 311.0, Hand::z), straight_line)), "");
  const std::vector<Vec3> tight = {{0, 0, 0}, {1, 0.6, 0}, {1.4, 0, 0}, {1, -0.6, 0}, {0, -0.7, 0}};
  EXPECT_TRUE(has(error_of(fabric_with(ply_thread(3, 10.0, Hand::z), tight)), "too tight"))
      << error_of(fabric_with(ply_thread(3, 10.0, Hand::z), tight));
  Thread flat = ply_thread(3, 10.0, Hand::z);
  flat.section = yarn::Ellipse{2.0, 1.0};
  EXPECT_TRUE(has(error_of(fabric_with(flat, straight_line)), "round section"));
  const Fabric many = fabric_with(filament_thread(2000000000, 0.7), straight_line);
  EXPECT_TRUE(has(error_of(many, Detail::filaments), "--detail yarn"));
  EXPECT_EQ(error_of(many), "");
  EXPECT_TRUE(
      has(error_of(fabric_with(ply_thread(1001, 1.0, Hand::z), straight_line)), "at most 1000 plies"));
  Fabric sized = fabric_with(filament_thread(3, 0.5), straight_line);
  std::get<Path>(std::get<Yarn>(sized.items[0]).shape).sizes = {SizeAt{1.0, 1.0, {}}, SizeAt{2.0, 2.0, {}}};
  EXPECT_TRUE(has(error_of(sized), "same section all along"));
}

}  // namespace selvage::fabric
