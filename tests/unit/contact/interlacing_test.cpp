// Which movements take a line through another one. The oracle for closed lines is the Gauss linking integral:
// it changes only when one line goes through the other, and by one each time.
#include "contact/interlacing.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "nurbs/interpolate.h"

namespace selvage::contact {
namespace {

using std::numbers::pi;
using Points = std::vector<Vec3>;

// A yarn with this centre line; of its surface only the size matters here.
yarn::Body body_of(const Points& points, double width, bool closed = false) {
  yarn::Body body;
  body.name = "yarn";
  body.closed_along = closed;
  // The same parameters whatever the points are, as of yarns that are moved.
  std::vector<double> parameters;
  const std::size_t spans = points.size() - (closed ? 0 : 1);
  for (std::size_t i = 0; i <= spans; ++i)
    parameters.push_back(static_cast<double>(i) / static_cast<double>(spans));
  if (closed) {
    body.axis = nurbs::interpolate_closed(points, parameters);
  } else {
    const auto spans_d = static_cast<double>(spans);
    body.axis = nurbs::interpolate(points, parameters, spans_d * (points[1] - points[0]),
                                   spans_d * (points[spans] - points[spans - 1]));
  }
  body.surface.count_u = 4;
  body.surface.count_v = 1;
  body.surface.points = {{0, 0, 0}, {width, 0, 0}, {width, 0, 0}, {0, 0, 0}};
  return body;
}

yarn::Body straight(const Vec3& from, const Vec3& to, double width) {
  Points points;
  for (int i = 0; i <= 4; ++i) points.push_back(from + (to - from) * i / 4.0);
  return body_of(points, width);
}

std::vector<Passage> passages(const std::vector<yarn::Body>& before, const std::vector<yarn::Body>& after) {
  const Result<std::vector<Passage>> found = find_passages(before, after);
  EXPECT_TRUE(found.ok()) << (found.ok() ? "" : found.error().text);
  return found.ok() ? *found : std::vector<Passage>{};
}

TEST(Passages, NothingMovesNothingPasses) {
  const std::vector<yarn::Body> yarns = {straight({-3, 0, 0.3}, {3, 0, 0.3}, 1),
                                         straight({0, -3, -0.3}, {0, 3, -0.3}, 1)};
  EXPECT_TRUE(passages(yarns, yarns).empty());
}

// Deep in each other, pulled apart to the side on which each lies: no passage. To the other side: one, where
// and when the lines cross.
TEST(Passages, TwoCrossingYarns) {
  const std::vector<yarn::Body> before = {straight({-3, 0, 0.1}, {3, 0, 0.1}, 1),
                                          straight({0, -3, -0.1}, {0, 3, -0.1}, 1)};
  const std::vector<yarn::Body> apart = {straight({-3, 0, 0.6}, {3, 0, 0.6}, 1),
                                         straight({0, -3, -0.6}, {0, 3, -0.6}, 1)};
  const std::vector<yarn::Body> through = {straight({-3, 0, -0.3}, {3, 0, -0.3}, 1),
                                           straight({0, -3, 0.3}, {0, 3, 0.3}, 1)};
  EXPECT_TRUE(passages(before, apart).empty());
  const std::vector<Passage> found = passages(before, through);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].a, 0U);
  EXPECT_EQ(found[0].b, 1U);
  EXPECT_NEAR(found[0].time, 0.25, 1e-2);
  EXPECT_NEAR(found[0].at_a, 0.5, 1e-2);
  EXPECT_NEAR(found[0].at_b, 0.5, 1e-2);
  EXPECT_LT(found[0].at.norm(), 0.02);
}

// A yarn that slides along another one, or past its end, goes through nothing.
TEST(Passages, SlidingIsNoPassage) {
  const yarn::Body fixed = straight({-3, 0, 0}, {3, 0, 0}, 1);
  const std::vector<yarn::Body> before = {fixed, straight({0, -3, 0.5}, {0, 3, 0.5}, 1)};
  EXPECT_TRUE(passages(before, {fixed, straight({2, -3, 0.5}, {2, 3, 0.5}, 1)}).empty());
  EXPECT_TRUE(passages({fixed, straight({4, -3, 0.5}, {4, 3, 0.5}, 1)},
                       {fixed, straight({4, -3, -0.5}, {4, 3, -0.5}, 1)})
                  .empty());
}

// Two yarns that cross three times, turned over as a whole: three places.
TEST(Passages, EachPlaceIsOne) {
  Points wave, line;
  for (int i = 0; i <= 36; ++i) {
    const double x = i * 0.5;
    wave.emplace_back(x, 2 * std::cos(x * pi / 6), 0.3);
    line.emplace_back(x, 0, 0);
  }
  std::vector<yarn::Body> before = {body_of(wave, 0.5), body_of(line, 0.5)}, after = before;
  for (Vec3& p : after[0].axis.points) p.z() = -0.3;
  const std::vector<Passage> found = passages(before, after);
  ASSERT_EQ(found.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(found[k].at.x(), 3.0 + 6.0 * static_cast<double>(k), 0.05);
    EXPECT_NEAR(found[k].time, 0.5, 0.02);
  }
}

// A yarn that crosses over itself, as a knitted loop does.
TEST(Passages, AYarnThroughItself) {
  const auto loop = [](double height) {
    Points points;
    for (int i = 0; i <= 24; ++i) {
      const double t = -1.2 + 2.4 * i / 24.0, angle = t * pi;
      points.emplace_back(2 * std::sin(angle), -2 * std::cos(angle), height * t);
    }
    return body_of(points, 0.4);
  };
  EXPECT_TRUE(passages({loop(0.3)}, {loop(0.5)}).empty());
  const std::vector<Passage> found = passages({loop(0.3)}, {loop(-0.3)});
  ASSERT_GE(found.size(), 1U);
  EXPECT_EQ(found[0].a, 0U);
  EXPECT_EQ(found[0].b, 0U);
}

TEST(Passages, YarnsThatDoNotCorrespond) {
  const yarn::Body one = straight({-3, 0, 0}, {3, 0, 0}, 1);
  EXPECT_FALSE(find_passages(std::vector{one}, std::vector{one, one}).ok());
  yarn::Body other = one;
  for (double& knot : other.axis.knots) knot *= 2;
  EXPECT_FALSE(find_passages(std::vector{one}, std::vector{other}).ok());
  yarn::Body broken = one;
  broken.axis.points[1].x() = std::nan("");
  EXPECT_FALSE(find_passages(std::vector{one}, std::vector{broken}).ok());
}

// The linking number of two closed polygons: the solid angles of all pairs of their sides, summed (Klenin and
// Langowski, Biopolymers 54, 2000, method 1a).
double linking(const Points& a, const Points& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < b.size(); ++k) {
      const Vec3 &p1 = a[i], &p2 = a[(i + 1) % a.size()], &p3 = b[k], &p4 = b[(k + 1) % b.size()];
      const Vec3 r13 = p3 - p1, r14 = p4 - p1, r23 = p3 - p2, r24 = p4 - p2;
      const std::array<Vec3, 4> n = {r13.cross(r14).normalized(), r14.cross(r24).normalized(),
                                     r24.cross(r23).normalized(), r23.cross(r13).normalized()};
      double area = 0;
      for (std::size_t s = 0; s < 4; ++s) area += std::asin(std::clamp(n[s].dot(n[(s + 1) % 4]), -1.0, 1.0));
      const double sign = (p4 - p3).cross(p2 - p1).dot(r13);
      sum += sign > 0 ? area : -area;
    }
  return sum / (4 * pi);
}

Points sampled(const yarn::Body& body) {
  Points points;
  for (int i = 0; i < 240; ++i) points.push_back(nurbs::evaluate(body.axis, i / 240.0));
  return points;
}

TEST(Passages, RandomClosedLinesAgreeWithTheirLinkingNumber) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto ring = [&](const Vec3& centre) {
    // A few harmonics.
    std::array<Vec3, 6> c;
    for (Vec3& v : c) v = Vec3(normal(random), normal(random), normal(random));
    Points points;
    for (int i = 0; i < 24; ++i) {
      Vec3 p = centre;
      for (int k = 1; k <= 3; ++k)
        p += (c[2 * static_cast<std::size_t>(k) - 2] * std::cos(2 * pi * k * i / 24) +
              c[2 * static_cast<std::size_t>(k) - 1] * std::sin(2 * pi * k * i / 24)) /
             k;
      points.push_back(p);
    }
    return points;
  };
  int changed = 0, unchanged = 0;
  for (int trial = 0; trial < 120; ++trial) {
    const Points a = ring(Vec3::Zero()), b = ring(Vec3(1, 0, 0));
    Points moved = b;
    const double far = trial % 3 == 0 ? 0.1 : 0.8;
    const Vec3 shift = far * Vec3(normal(random), normal(random), normal(random));
    for (Vec3& p : moved) p += shift;
    const double width = 0.02;
    const std::vector<yarn::Body> before = {body_of(a, width, true), body_of(b, width, true)},
                                  after = {body_of(a, width, true), body_of(moved, width, true)};
    const double from = linking(sampled(before[0]), sampled(before[1])),
                 to = linking(sampled(after[0]), sampled(after[1]));
    // The polygons of the oracle are no lines: where these are very near each other it says nothing.
    if (std::abs(from - std::round(from)) > 1e-6 || std::abs(to - std::round(to)) > 1e-6) continue;
    int between = 0;
    for (const Passage& passage : passages(before, after)) between += passage.a != passage.b ? 1 : 0;
    const int change = std::abs(static_cast<int>(std::round(to) - std::round(from)));
    EXPECT_GE(between, change) << trial;
    EXPECT_EQ((between - change) % 2, 0) << trial;  // through and back again
    (change > 0 ? changed : unchanged) += 1;
  }
  EXPECT_GT(changed, 15);
  EXPECT_GT(unchanged, 30);
}

}  // namespace
}  // namespace selvage::contact
