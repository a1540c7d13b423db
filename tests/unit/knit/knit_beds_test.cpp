// Which side of a weft knit shows which loops, from the crossings of its built centre lines: no chart is
// asked.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "construction/build.h"
#include "knit/knit.h"
#include "nurbs/measure.h"

namespace selvage::fabric {
namespace {

constexpr double beds_radius = 0.1;

std::vector<YarnPlan> plans_of(Knit knit) {
  Fabric fabric;
  fabric.file = "test.txt";
  Thread thread;
  thread.name = "t";
  thread.diameter = 2 * beds_radius;
  fabric.threads = {thread};
  knit.threads = {"t"};
  fabric.items = {knit};
  Diagnostics diagnostics;
  const Result<std::unique_ptr<Construction>> made =
      make_knit(fabric, std::get<Knit>(fabric.items.front()), {}, diagnostics);
  EXPECT_TRUE(made.ok());
  EXPECT_TRUE(diagnostics.messages().empty());
  std::vector<YarnPlan> plans;
  for (std::size_t i = 0; i < (*made)->count(); ++i) {
    plans.push_back(std::move(*(*made)->plan(i)));
    tell_from_origin(plans.back());
  }
  return plans;
}

Knit named(Knit::Form form, int courses, int wales) {
  Knit knit;
  knit.form = form;
  knit.courses = courses;
  knit.wales = wales;
  return knit;
}

// What a yarn does between two planes x = const.
std::vector<Vec3> strip(const YarnPlan& plan, double from, double to) {
  std::vector<Vec3> points;
  const std::vector<double>& t = plan.line.parameters;
  const int steps = 40 * static_cast<int>(t.size());
  for (int i = 0; i <= steps; ++i) {
    const Vec3 p = nurbs::evaluate(plan.line.curve, t.front() + (t.back() - t.front()) * i / steps);
    if (p.x() >= from && p.x() <= to) points.push_back(p);
  }
  return points;
}

struct Crossing {
  double y = 0, height = 0;  // by how much the first yarn lies in front of the second
};

// Seen along z, from the lowest to the highest.
std::vector<Crossing> crossings(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  const auto cross = [](const Vec2& u, const Vec2& v) { return u.x() * v.y() - u.y() * v.x(); };
  std::vector<Crossing> found;
  constexpr double step = 0.5 * beds_radius;  // longer ones lead from one visit of the strip to the next
  for (std::size_t i = 0; i + 1 < a.size(); ++i)
    for (std::size_t k = 0; k + 1 < b.size(); ++k) {
      const Vec3 da = a[i + 1] - a[i], db = b[k + 1] - b[k], off = b[k] - a[i];
      if (da.norm() > step || db.norm() > step || off.head<2>().norm() > 2 * step) continue;
      const double det = cross(da.head<2>(), db.head<2>());
      if (det == 0) continue;
      const double s = cross(off.head<2>(), db.head<2>()) / det, u = cross(off.head<2>(), da.head<2>()) / det;
      if (s < 0 || s >= 1 || u < 0 || u >= 1) continue;
      found.push_back({a[i].y() + s * da.y(), a[i].z() + s * da.z() - b[k].z() - u * db.z()});
    }
  std::sort(found.begin(), found.end(), [](const Crossing& p, const Crossing& q) { return p.y < q.y; });
  return found;
}

enum class Shows { face, back, nothing };

// The stitch by which `upper` goes through the loop of `lower` in a wale, seen from the front. Two legs pass
// a head: before it on the face, behind it on the back; below, the two arms pass the other loop's legs the
// other way.
Shows stitch_of(const YarnPlan& upper, const YarnPlan& lower, double from, double to) {
  const std::vector<Crossing> found = crossings(strip(upper, from, to), strip(lower, from, to));
  if (found.size() != 4) return Shows::nothing;
  const auto all = [&](std::size_t first, double sign) {
    return sign * found[first].height > 1.5 * beds_radius &&
           sign * found[first + 1].height > 1.5 * beds_radius;
  };
  if (all(0, -1) && all(2, 1)) return Shows::face;
  if (all(0, 1) && all(2, -1)) return Shows::back;
  return Shows::nothing;
}

TEST(KnitBeds, JerseyAndPurlAreTold) {
  const std::vector<YarnPlan> jersey = plans_of(named(Knit::Form::jersey, 6, 6));
  const std::vector<YarnPlan> purl = plans_of(named(Knit::Form::purl, 6, 6));
  for (std::size_t course = 1; course < 6; ++course)
    for (int wale = 0; wale < 6; ++wale) {
      const double x = 8 * beds_radius * wale;
      EXPECT_EQ(stitch_of(jersey[course], jersey[course - 1], x, x + 8 * beds_radius), Shows::face);
      EXPECT_EQ(stitch_of(purl[course], purl[course - 1], x, x + 8 * beds_radius),
                course % 2 == 0 ? Shows::face : Shows::back);
    }
}

// Two ribs through each other: in every wale one yarn of a course has a face loop in front, the other one
// behind.
TEST(KnitBeds, InterlockShowsFaceLoopsOnBothSides) {
  const std::vector<YarnPlan> plans = plans_of(named(Knit::Form::interlock, 5, 6));
  ASSERT_EQ(plans.size(), 10U);
  EXPECT_EQ(plans[3].name, "course_2_2");
  for (std::size_t row = 2; row < 10; ++row)
    for (int wale = 0; wale < 6; ++wale) {
      const double x = 8 * beds_radius * wale;
      const bool in_front = (static_cast<int>(row) + wale) % 2 == 0;
      EXPECT_EQ(stitch_of(plans[row], plans[row - 2], x, x + 8 * beds_radius),
                in_front ? Shows::face : Shows::back)
          << row << " " << wale;
      // The loops in front lie before those behind wherever they cross, but at the wale's sides, where yarns
      // change.
      for (const Crossing& c : crossings(strip(plans[row], x + 1.5 * beds_radius, x + 6.5 * beds_radius),
                                         strip(plans[row - 1], x + 1.5 * beds_radius, x + 6.5 * beds_radius)))
        EXPECT_GT(in_front ? c.height : -c.height, 1.5 * beds_radius) << row << " " << wale;
    }
}

// The two yarns of a course cross between wales, from bed to bed: neither rib can be taken out of the other.
TEST(KnitBeds, InterlockCrossesBetweenWales) {
  const std::vector<YarnPlan> plans = plans_of(named(Knit::Form::interlock, 5, 6));
  for (std::size_t row = 2; row < 9; ++row)
    for (int side = 1; side < 6; ++side) {
      const auto z_at = [&](const YarnPlan& plan, double from, double to) {
        double sum = 0;
        const std::vector<Vec3> points = strip(plan, from, to);
        for (const Vec3& p : points) sum += p.z();
        return sum / static_cast<double>(points.size());
      };
      const double x = 8 * beds_radius * side;
      const double left =
          z_at(plans[row], x - 4 * beds_radius, x) - z_at(plans[row + 1], x - 4 * beds_radius, x);
      const double right =
          z_at(plans[row], x, x + 4 * beds_radius) - z_at(plans[row + 1], x, x + 4 * beds_radius);
      EXPECT_LT(left * right, 0) << row << " " << side;
    }
}

// Loops of every second course, with a tuck between: the face of the front wales is in front, that of the
// back wales behind. The tuck lies with the head that it is held with: the legs pass both on the same side.
TEST(KnitBeds, FullCardiganShowsFaceLoopsOnBothSides) {
  const std::vector<YarnPlan> plans = plans_of(named(Knit::Form::full_cardigan, 8, 6));
  for (std::size_t row = 3; row < 8; ++row)
    for (int wale = 0; wale < 6; ++wale) {
      const double x = 8 * beds_radius * wale;
      if ((static_cast<int>(row) + wale) % 2 != 0) continue;  // a tuck
      const bool in_front = wale % 2 == 0;
      EXPECT_EQ(stitch_of(plans[row], plans[row - 2], x, x + 8 * beds_radius),
                in_front ? Shows::face : Shows::back)
          << row << " " << wale;
      const std::vector<Crossing> tuck =
          crossings(strip(plans[row], x + beds_radius, x + 7 * beds_radius),
                    strip(plans[row - 1], x + beds_radius, x + 7 * beds_radius));
      ASSERT_GE(tuck.size(), 2U);
      for (std::size_t k = tuck.size() - 2; k < tuck.size(); ++k)
        EXPECT_GT(in_front ? tuck[k].height : -tuck[k].height, 1.5 * beds_radius) << row << " " << wale;
    }
}

// Two cloths of jersey, face outwards, that the third yarn holds together.
TEST(KnitBeds, ASpacerHasTwoFacesAndAYarnBetween) {
  Knit knit = named(Knit::Form::chart, 4, 6);
  knit.chart = {"TU", "PP", "KK"};
  knit.gating = Knit::Gating::opposite;
  knit.bed_distance = 30 * beds_radius;
  knit.feeds = 3;
  knit.course_pitch = 9 * beds_radius;
  knit.wale_pitch = 10 * beds_radius;
  const std::vector<YarnPlan> plans = plans_of(knit);
  ASSERT_EQ(plans.size(), 12U);
  for (std::size_t row = 3; row < 12; ++row)
    for (int wale = 0; wale < 6; ++wale) {
      const double x = 10 * beds_radius * wale, end = x + 10 * beds_radius;
      if (row % 3 == 2) {
        const std::vector<Vec3> points = strip(plans[row], x, end);
        const auto [least, most] = std::minmax_element(
            points.begin(), points.end(),
            [](const Vec3& a, const Vec3& b) { return std::abs(a.z()) < std::abs(b.z()); });
        EXPECT_LT(std::abs(least->z()), 3 * beds_radius);
        EXPECT_GT(wale % 2 == 0 ? most->z() : -most->z(), 10 * beds_radius);
      } else {
        EXPECT_EQ(stitch_of(plans[row], plans[row - 3], x, end), row % 3 == 0 ? Shows::face : Shows::back);
      }
    }
}

// The plating yarn goes with the ground, behind it everywhere, through the loops of both.
TEST(KnitBeds, APlatedJerseyShowsOneYarnOnEachSide) {
  Knit knit = named(Knit::Form::jersey, 5, 5);
  knit.plating = "t";
  knit.course_pitch = 8.5 * beds_radius;
  knit.wale_pitch = 10 * beds_radius;
  for (const bool has_pile : {false, true}) {
    if (has_pile) knit.pile = 14 * beds_radius;
    const std::vector<YarnPlan> plans = plans_of(knit);
    ASSERT_EQ(plans.size(), 10U);
    EXPECT_EQ(plans[3].name, has_pile ? "course_2_pile" : "course_2_plating");
    for (std::size_t course = 1; course < 5; ++course)
      for (int wale = 0; wale < 5; ++wale) {
        const double x = 10 * beds_radius * wale, end = x + 10 * beds_radius;
        const YarnPlan &ground = plans[2 * course], &plating = plans[2 * course + 1];
        for (const YarnPlan* upper : {&ground, &plating})
          for (const YarnPlan* lower : {&plans[2 * course - 2], &plans[2 * course - 1]}) {
            // Limbs of the pile add crossings of their own, behind everything.
            if (has_pile && (upper == &plating || lower == &plans[2 * course - 1])) continue;
            EXPECT_EQ(stitch_of(*upper, *lower, x, end), Shows::face) << course << " " << wale;
          }
        for (const Crossing& c : crossings(strip(ground, x, end), strip(plating, x, end)))
          EXPECT_GT(c.height, 1.8 * beds_radius);
      }
  }
}

TEST(KnitBeds, PileStandsOutOfTheBack) {
  Knit knit = named(Knit::Form::jersey, 5, 5);
  knit.plating = "t";
  knit.course_pitch = 8.5 * beds_radius;
  knit.wale_pitch = 10 * beds_radius;
  knit.pile = 14 * beds_radius;
  const auto lowest_of = [](const YarnPlan& plan) {
    const std::vector<Vec3> points = strip(plan, -1e9, 1e9);
    return std::min_element(points.begin(), points.end(),
                            [](const Vec3& a, const Vec3& b) { return a.z() < b.z(); })
        ->z();
  };
  const std::vector<YarnPlan> terry = plans_of(knit);
  knit.pile.reset();
  const std::vector<YarnPlan> plain = plans_of(knit);
  knit.pile = 14 * beds_radius;
  knit.pile_is_cut = true;
  const std::vector<YarnPlan> cut = plans_of(knit);
  ASSERT_EQ(cut.size(), 5U * 6U);
  EXPECT_EQ(cut[8].name, "course_2_tuft_2");
  for (std::size_t course = 1; course < 4; ++course) {
    // The height is that above the published back of the two yarns, of which loops move by less than a yarn.
    EXPECT_NEAR(lowest_of(plain[2 * course + 1]) - lowest_of(terry[2 * course + 1]), 14 * beds_radius,
                2 * beds_radius);
    EXPECT_NEAR(lowest_of(terry[2 * course]), lowest_of(plain[2 * course]), beds_radius);
    for (std::size_t tuft = 0; tuft < 5; ++tuft) {
      // A tuft is one stitch: both ends below, the middle over the head of the loop below.
      const YarnPlan& plan = cut[6 * course + 1 + tuft];
      EXPECT_NEAR(plan.points.front().z(), plan.points.back().z(), beds_radius);
      EXPECT_LT(plan.points.front().z(), lowest_of(plain[2 * course + 1]) - 10 * beds_radius);
      EXPECT_EQ(stitch_of(plan, cut[6 * (course - 1)], 10 * beds_radius * static_cast<double>(tuft),
                          10 * beds_radius * static_cast<double>(tuft + 1)),
                Shows::face);
    }
  }
}

}  // namespace
}  // namespace selvage::fabric
