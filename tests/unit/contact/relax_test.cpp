// What a relaxation promises, measured here by sampling and by CGAL, not by what the relaxation says of
// itself.
#include "contact/relax.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>

#include "contact/alike.h"
#include "contact/interlacing.h"
#include "solid/check.h"
#include "solid/tessellation.h"
#include "unit/solid/bodies.h"

namespace selvage::contact {
namespace {

using test::straight;
using test::TubeForm;

using std::numbers::pi;

// The outline of the section at v as a fine polygon.
std::vector<Vec3> outline(const yarn::Body& body, double v, int points = 360) {
  const nurbs::Surface& s = body.surface;
  std::vector<double> us;
  for (int i = 0; i < points; ++i) us.push_back(s.first_u() + (s.last_u() - s.first_u()) * i / points);
  return nurbs::evaluate_grid(s, us, {v});
}

struct Section {
  Vec3 centre = Vec3::Zero();  // of the enclosed area
  double area = 0;
  double least_turning = std::numeric_limits<double>::infinity();  // radians
};

Section section(const yarn::Body& body, double v) {
  const std::vector<Vec3> p = outline(body, v);
  const std::size_t n = p.size();
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < n; ++i) sum += 0.5 * (p[i] - p[0]).cross(p[(i + 1) % n] - p[0]);
  Section out;
  out.area = sum.norm();
  const Vec3 normal = sum.normalized();
  for (std::size_t i = 0; i < n; ++i) {
    const double part = 0.5 * (p[i] - p[0]).cross(p[(i + 1) % n] - p[0]).dot(normal);
    out.centre += part / out.area * (p[0] + p[i] + p[(i + 1) % n]) / 3.0;
    const Vec3 a = p[(i + 1) % n] - p[i], b = p[(i + 2) % n] - p[(i + 1) % n];
    out.least_turning = std::min(out.least_turning, std::atan2(a.cross(b).dot(normal), a.dot(b)));
  }
  return out;
}

constexpr int places = 200;

double place(const yarn::Body& body, int k) {
  return body.surface.first_v() + (body.surface.last_v() - body.surface.first_v()) * k / places;
}

double length(const yarn::Body& body) {
  double sum = 0.0;
  Vec3 last = section(body, place(body, 0)).centre;
  for (int k = 1; k <= places; ++k) {
    const Vec3 next = section(body, place(body, k)).centre;
    sum += (next - last).norm();
    last = next;
  }
  return sum;
}

double volume(const yarn::Body& body) {
  const Result<solid::Tessellation> skin = solid::tessellate(body, 2e-4);
  EXPECT_TRUE(skin.ok());
  return skin.ok() ? solid::volume(*skin) : 0.0;
}

// Everything that the header promises of a solved relaxation.
void expect_sound(const std::vector<yarn::Body>& before, const Relaxation& relaxed, double gap) {
  ASSERT_TRUE(relaxed.solved) << relaxed.reason;
  ASSERT_EQ(relaxed.bodies.size(), before.size());
  const Result<solid::SolidCheck> check = solid::check_solids(relaxed.bodies, {});
  ASSERT_TRUE(check.ok());
  EXPECT_TRUE(check->overlaps.empty());
  if (check->min_gap) {
    EXPECT_GE(*check->min_gap, 0.99 * gap);
  }
  for (std::size_t y = 0; y < before.size(); ++y) {
    SCOPED_TRACE(before[y].name);
    const yarn::Body& body = relaxed.bodies[y];
    EXPECT_EQ(body.name, before[y].name);
    EXPECT_TRUE(check->yarns[y].is_shut());
    EXPECT_FALSE(check->yarns[y].self_intersecting);
    EXPECT_TRUE(check->yarns[y].defects.empty());
    for (int k = 0; k <= places; ++k) {
      const Section now = section(body, place(body, k)), old = section(before[y], place(before[y], k));
      ASSERT_NEAR(now.area / old.area, 1.0, area_bound) << k;
      if (old.least_turning > -1e-9) {
        ASSERT_GT(now.least_turning, -1e-6) << k;
      }
    }
    EXPECT_NEAR(length(body) / length(before[y]), 1.0, length_bound);
    EXPECT_NEAR(volume(body) / volume(before[y]), 1.0, volume_bound);
    for (bool last : {false, true}) {
      const yarn::EndFace& end = last ? before[y].end : before[y].start;
      if (end.style == yarn::EndStyle::none || before[y].closed_along) continue;
      const double v = last ? body.surface.last_v() : body.surface.first_v();
      for (const Vec3& p : outline(body, v)) ASSERT_NEAR((p - end.origin).dot(end.normal), 0.0, 1e-9);
    }
  }
  const Result<std::vector<Passage>> passages = find_passages(before, relaxed.bodies);
  ASSERT_TRUE(passages.ok());
  EXPECT_TRUE(passages->empty());
}

Relaxation run(const std::vector<yarn::Body>& bodies, const RelaxOptions& options = {}) {
  Result<Relaxation> relaxed = relax(bodies, options);
  EXPECT_TRUE(relaxed.ok()) << (relaxed.ok() ? "" : to_string(relaxed.error()));
  return relaxed.ok() ? std::move(*relaxed) : Relaxation{};
}

TubeForm round(double radius) {
  return {radius, radius, 32, 8};
}

// Two round yarns of radius 0.5 and 0.3 that cross at right angles, their surfaces `depth` in each other.
std::vector<yarn::Body> crossing(double depth) {
  return {straight("a", round(0.5), Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 8.0),
          straight("b", round(0.3), {0, 0, 0.8 - depth}, {0, 1, 0}, {0, 0, 1}, 8.0)};
}

TEST(Relax, CrossingRoundYarns) {
  for (double depth : {0.0, 0.02, 0.1, 0.2}) {
    SCOPED_TRACE(depth);
    const std::vector<yarn::Body> bodies = crossing(depth);
    const Relaxation relaxed = run(bodies);
    expect_sound(bodies, relaxed, 0.006);
    EXPECT_EQ(relaxed.before.overlaps, depth > 0.0 ? 1U : 0U);
    EXPECT_NEAR(relaxed.before.depth, depth, 0.01 * depth + 1e-6);
    EXPECT_EQ(relaxed.after.overlaps, 0U);
  }
}

TEST(Relax, TheWantedGap) {
  const std::vector<yarn::Body> bodies = crossing(0.05);
  RelaxOptions options;
  options.gap = 0.08;
  const Relaxation relaxed = run(bodies, options);
  expect_sound(bodies, relaxed, 0.08);
  ASSERT_TRUE(relaxed.after.min_gap.has_value());
  // No farther than needed.
  EXPECT_LT(*relaxed.after.min_gap, 0.12);
}

// Of parallel yarns that are one shape the first and the last have neighbours on one side only.
TEST(Relax, YarnsWithTheSameNeighboursAreAlike) {
  constexpr std::size_t count = 8;
  std::vector<yarn::Body> bodies;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 at = 2.1 * static_cast<double>(k) * Vec3::UnitY();
    bodies.push_back(straight("yarn", {}, at, Vec3::UnitX(), Vec3::UnitY(), 6.0));
    bodies.back().shape = 1;
    bodies.back().at = at;
  }
  const std::vector<std::size_t> marks(count, 0);
  const Alike alike = find_alike(bodies, 0.5, marks);
  EXPECT_EQ(alike.first, (std::vector<std::size_t>{0, 1, 1, 1, 1, 1, 1, 7}));
  EXPECT_EQ(alike.few, (std::vector<std::size_t>{0, 1, 2, 6, 7}));
  using Pair = std::pair<std::size_t, std::size_t>;
  const std::map<Pair, std::size_t> expected = {{{0, 0}, 1}, {{0, 1}, 1}, {{1, 1}, 6},
                                                {{1, 2}, 5}, {{6, 7}, 1}, {{7, 7}, 1}};
  EXPECT_EQ(alike.neighbours, expected);
  bodies[3].shape = 0;  // nobody knows what it is
  EXPECT_EQ(find_alike(bodies, 0.5, marks).first, (std::vector<std::size_t>{0, 1, 2, 3, 4, 1, 1, 7}));
}

TEST(Relax, WhatIsFreeIsNotTouched) {
  const std::vector<yarn::Body> bodies = crossing(-0.01);
  const Relaxation relaxed = run(bodies);
  ASSERT_TRUE(relaxed.solved);
  EXPECT_EQ(relaxed.iterations, 0);
  for (std::size_t y = 0; y < bodies.size(); ++y)
    EXPECT_EQ(relaxed.bodies[y].surface.points, bodies[y].surface.points);
}

TEST(Relax, StiffSectionsStayRound) {
  const std::vector<yarn::Body> bodies = crossing(0.1);
  RelaxOptions options;
  options.stiff_section = true;
  const Relaxation relaxed = run(bodies, options);
  expect_sound(bodies, relaxed, 0.006);
  for (std::size_t y = 0; y < bodies.size(); ++y) {
    const double radius = y == 0 ? 0.5 : 0.3;
    for (int k = 0; k <= places; ++k) {
      const double v = place(relaxed.bodies[y], k);
      const Vec3 centre = section(relaxed.bodies[y], v).centre;
      for (const Vec3& p : outline(relaxed.bodies[y], v, 24))
        ASSERT_NEAR((p - centre).norm(), radius, 0.005 * radius) << bodies[y].name << ' ' << k;
    }
  }
}

TEST(Relax, FixedPointsStay) {
  const std::vector<yarn::Body> bodies = crossing(0.1);
  RelaxOptions options;
  const double middle = 0.5 * (bodies[0].surface.first_v() + bodies[0].surface.last_v());
  options.fixed = {{0, middle}};
  const Relaxation relaxed = run(bodies, options);
  expect_sound(bodies, relaxed, 0.006);
  const auto centre = [&](const yarn::Body& body) { return nurbs::evaluate(body.axis, middle); };
  EXPECT_LT((centre(relaxed.bodies[0]) - centre(bodies[0])).norm(), 1e-4);
  EXPECT_GT((centre(relaxed.bodies[1]) - centre(bodies[1])).norm(), 0.02);
}

TEST(Relax, FlatYarns) {
  // Ellipses 0.8 x 0.2 that lie in each other, one on edge in the other, and side by side.
  const TubeForm flat{0.4, 0.1, 32, 8};
  const yarn::Body a = straight("a", flat, Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 5.0);
  for (const yarn::Body& b : {straight("b", flat, {0, 0, 0.17}, {0, 1, 0}, {1, 0, 0}, 5.0),
                              straight("b", flat, {0, 0, 0.46}, {0, 1, 0}, {0, 0, 1}, 5.0),
                              straight("b", flat, {0, 0.77, 0.0}, {1, 0, 0}, {0, 1, 0}, 5.0)}) {
    const std::vector<yarn::Body> bodies = {a, b};
    expect_sound(bodies, run(bodies), 0.002);
  }
}

TEST(Relax, AYarnThatMeetsItself) {
  // A loop that crosses itself in plan, at t = -1 and 1.
  const auto way = [](double t) -> Vec3 { return {3.0 * t * t, 3.0 * (t * t * t - t), 0.48 * t}; };
  const auto parameter = [](double s) { return 3.2 * s - 1.6; };
  const yarn::Body loop = test::tube("loop", {0.5, 0.5, 32, 60}, [&](double s, double x, double y) -> Vec3 {
    const double t = parameter(s);
    const Vec3 along = (way(t + 1e-5) - way(t - 1e-5)).normalized(),
               across = along.cross(Vec3::UnitZ()).normalized();
    return way(t) + x * across + y * along.cross(across);
  });
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 1000; ++i)
    for (int j = 0; j < 1000; ++j)
      nearest = std::min(nearest, (way(-0.7 - i * 6e-4) - way(0.7 + j * 6e-4)).norm());
  const Relaxation relaxed = run({loop});
  EXPECT_EQ(relaxed.before.overlaps, 1U);
  EXPECT_NEAR(relaxed.before.depth, 1.0 - nearest, 0.002);
  expect_sound({loop}, relaxed, 0.0);
}

TEST(Relax, ARingRoundAYarn) {
  // The ring's inside has the radius 0.5, the yarn in it 0.45, off the middle by 0.1.
  const std::vector<yarn::Body> bodies = {
      test::ring("ring", 0.7, 0.2), straight("yarn", round(0.45), {0.1, 0, 0}, {0, 0, 1}, {1, 0, 0}, 6.0)};
  const Relaxation relaxed = run(bodies);
  expect_sound(bodies, relaxed, 0.004);
  const nurbs::Surface& s = relaxed.bodies[0].surface;
  for (int i = 0; i < s.count_u; ++i) EXPECT_EQ(s.point(i, 0), s.point(i, s.count_v - 1));
}

TEST(Relax, AWantedOverlapIsMade) {
  RelaxOptions options;
  options.gap = -0.03;
  options.make_contact = true;
  for (double depth : {0.1, 0.01}) {
    SCOPED_TRACE(depth);
    const Relaxation relaxed = run(crossing(depth), options);
    ASSERT_TRUE(relaxed.solved) << relaxed.reason;
    const Result<solid::SolidCheck> check = solid::check_solids(relaxed.bodies, {});
    ASSERT_TRUE(check.ok());
    ASSERT_FALSE(check->overlaps.empty());
    EXPECT_NEAR(check->overlaps[0].depth(), 0.03, 0.002);
  }
}

TEST(Relax, PeriodsAreKept) {
  // A wave of period 2 over straight yarns at every half period, and its neighbour one period away: all of
  // them repeat by (2, 0, 0) and (0, 3, 0).
  std::vector<yarn::Body> bodies;
  for (int n = 0; n < 2; ++n)
    bodies.push_back(
        test::tube("wave" + std::to_string(n), {0.2, 0.2, 32, 61}, [n](double s, double x, double y) -> Vec3 {
          const double t = 6.0 * s;
          const double slope = -0.35 * pi * std::sin(pi * t);
          const Vec3 along = Vec3(1.0, 0.0, slope).normalized();
          return Vec3(t, 3.0 * n, 0.35 * std::cos(pi * t)) + x * Vec3::UnitY() +
                 y * along.cross(Vec3::UnitY());
        }));
  for (int k = 0; k < 7; ++k)
    bodies.push_back(straight("bar" + std::to_string(k), round(0.2), {static_cast<double>(k), 1.5, 0.0},
                              {0, 1, 0}, {0, 0, 1}, 6.0));
  RelaxOptions options;
  options.periods = {{2, 0, 0}, {0, 3, 0}};
  const Relaxation relaxed = run(bodies, options);
  expect_sound(bodies, relaxed, 0.004);
  const auto at = [&](std::size_t y, double share) {
    const yarn::Body& body = relaxed.bodies[y];
    return outline(body, body.surface.first_v() + share * (body.surface.last_v() - body.surface.first_v()),
                   48);
  };
  const auto expect_shifted = [&](const std::vector<Vec3>& p, const std::vector<Vec3>& q, const Vec3& by) {
    for (std::size_t i = 0; i < p.size(); ++i) ASSERT_LT((q[i] - p[i] - by).norm(), 1e-5);
  };
  // The two waves, and the bars two apart. (A wave's own sections stand evenly: equal parameters.)
  for (double share : {0.1, 0.37, 0.5, 0.62, 0.9}) {
    expect_shifted(at(0, share), at(1, share), {0, 3, 0});
    for (std::size_t k = 2; k + 2 < bodies.size(); ++k)
      expect_shifted(at(k, share), at(k + 2, share), {2, 0, 0});
  }
}

TEST(Relax, TheSameWithAnyNumberOfThreads) {
  RelaxOptions one, three;
  three.threads = 3;
  const Relaxation first = run(crossing(0.1), one), second = run(crossing(0.1), three);
  ASSERT_EQ(first.bodies.size(), second.bodies.size());
  for (std::size_t y = 0; y < first.bodies.size(); ++y)
    EXPECT_EQ(first.bodies[y].surface.points, second.bodies[y].surface.points);
}

// Four yarns on random waves through each other's neighbourhood, elliptic, two each way.
std::vector<yarn::Body> random_bundle(unsigned seed) {
  std::mt19937 random(seed);
  const auto between = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
  };
  std::vector<yarn::Body> bodies;
  for (int y = 0; y < 4; ++y) {
    const bool crosses = y % 2 == 1;
    const double half_width = between(0.2, 0.5), half_height = between(0.12, 0.2), place = between(-0.2, 0.2),
                 height = (crosses ? 1.0 : -1.0) * between(0.11, 0.2), wave = between(0.0, 0.15),
                 phase = between(0.0, 2.0 * pi), sway = between(0.0, 0.2);
    const auto way = [=](double s) -> Vec3 {
      const double t = 6.0 * s - 3.0, z = height + wave * std::sin(1.5 * t + phase),
                   across = place + 1.1 * (y / 2) + sway * std::cos(t + phase);
      return crosses ? Vec3(across, t, z) : Vec3(t, across, z);
    };
    bodies.push_back(test::tube("yarn" + std::to_string(y), {half_width, half_height, 24, 25},
                                [=](double s, double u, double v) -> Vec3 {
                                  const Vec3 along = (way(s + 1e-5) - way(s - 1e-5)).normalized(),
                                             side = Vec3::UnitZ().cross(along).normalized();
                                  return way(s) + u * side + v * along.cross(side);
                                }));
  }
  return bodies;
}

TEST(Relax, RandomBundles) {
  int solved = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const std::vector<yarn::Body> bodies = random_bundle(seed);
    const Relaxation relaxed = run(bodies);
    if (relaxed.solved) {
      ++solved;
      expect_sound(bodies, relaxed, 0.0024);
    } else {
      // Two of them overlap by more than half their thickness: nothing else is too hard.
      EXPECT_NE(relaxed.reason.find("run through each other"), std::string::npos) << relaxed.reason;
    }
  }
  EXPECT_GE(solved, 15);
}

void expect_refused(const std::vector<yarn::Body>& bodies, const RelaxOptions& options,
                    const std::string& word) {
  const Relaxation relaxed = run(bodies, options);
  EXPECT_FALSE(relaxed.solved);
  EXPECT_NE(relaxed.reason.find(word), std::string::npos) << relaxed.reason;
}

TEST(Relax, WhatCannotBeParted) {
  const yarn::Body a = straight("a", round(0.5), Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 6.0);
  expect_refused({a, straight("b", round(0.5), Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 6.0)}, {}, "run through");
  expect_refused({a, straight("b", round(0.5), Vec3::Zero(), {0, 1, 0}, {0, 0, 1}, 6.0)}, {}, "run through");
  expect_refused({a, straight("b", round(0.1), {0, 0, 0.1}, {1, 0, 0}, {0, 1, 0}, 5.0)}, {}, "run through");
  RelaxOptions wide;
  wide.gap = 0.7;
  expect_refused(crossing(0.0), wide, "vanish");
}

TEST(Relax, AJammedCloth) {
  // A yarn between two others that leave 0.7 of its thickness, all of them held in seven places.
  std::vector<yarn::Body> bodies = {straight("low", round(0.3), {0, 0, -0.5}, {1, 0, 0}, {0, 1, 0}, 4.0),
                                    straight("middle", round(0.3), {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4.0),
                                    straight("high", round(0.3), {0, 0, 0.5}, {1, 0, 0}, {0, 1, 0}, 4.0)};
  RelaxOptions options;
  options.stiff_section = true;
  for (std::size_t y = 0; y < bodies.size(); ++y)
    for (int k = 0; k <= 16; ++k) {
      const nurbs::Surface& s = bodies[y].surface;
      options.fixed.push_back({y, s.first_v() + (s.last_v() - s.first_v()) * k / 16.0});
    }
  const Relaxation relaxed = run(bodies, options);
  EXPECT_FALSE(relaxed.solved);
  ASSERT_FALSE(relaxed.jams.empty());
  // Between the places that are held the yarns can give way a little, there they cannot.
  EXPECT_GT(relaxed.jams[0].gap, -0.101);
  EXPECT_LT(relaxed.jams[0].gap, -0.07);
  for (const Jam& jam : relaxed.jams) EXPECT_TRUE(jam.a == 1 || jam.b == 1);
}

TEST(Relax, ABoundInTheWay) {
  // Two short yarns 0.28 in each other, their ends fixed: a bow that parts them is more than 1 % longer.
  std::vector<yarn::Body> bodies = {straight("a", round(0.3), Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 1.8),
                                    straight("b", round(0.3), {0, 0, 0.32}, {0, 1, 0}, {0, 0, 1}, 1.8)};
  RelaxOptions options;
  options.stiff_section = true;
  for (std::size_t y = 0; y < 2; ++y)
    options.fixed.insert(options.fixed.end(),
                         {{y, bodies[y].surface.first_v()}, {y, bodies[y].surface.last_v()}});
  const Relaxation relaxed = run(bodies, options);
  EXPECT_FALSE(relaxed.solved);
  EXPECT_FALSE(relaxed.reason.empty());
  // Something was gained, within the bounds, and what is left is told.
  ASSERT_EQ(relaxed.jams.size(), 1U);
  EXPECT_LT(relaxed.jams[0].gap, 0.0);
  EXPECT_GT(relaxed.jams[0].gap, -0.27);
  for (std::size_t y = 0; y < 2; ++y)
    EXPECT_LE(length(relaxed.bodies[y]) / length(bodies[y]), 1.0 + length_bound);
}

}  // namespace
}  // namespace selvage::contact
