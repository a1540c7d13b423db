// Grids: the published form of a yarn, and every word that says what differs.
#include "yarn/grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "yarn/finish.h"

namespace selvage::yarn {
namespace {

using std::numbers::pi;

// Sections of a round bar along x, control points counter-clockwise seen against x.
GridNet bar(int sections, int round, double length = 3.0) {
  GridNet net;
  net.sections = sections;
  net.per_section = round;
  for (int j = 0; j < sections; ++j)
    for (int i = 0; i < round; ++i) {
      const double a = 2 * pi * (i + 0.5) / round;
      net.points.emplace_back(length * j / (sections - 1), std::cos(a), std::sin(a));
    }
  return net;
}

TEST(GridTest, PublishedFormOfASixteenBySixteenYarn) {
  Body body;
  const GridNet net = bar(16, 16);
  ASSERT_TRUE(fill_from_grid(body, net).ok());
  const nurbs::Surface& s = body.surface;
  EXPECT_EQ(s.count_u, 18);
  EXPECT_EQ(s.count_v, 16);
  EXPECT_EQ(s.degree_u, 2);
  EXPECT_EQ(s.degree_v, 3);
  std::vector<double> round = {0, 0, 0};
  for (int i = 1; i < 16; ++i) round.push_back(i / 16.0);
  round.insert(round.end(), 3, 1.0);
  EXPECT_EQ(s.knots_u, round);
  EXPECT_EQ(s.knots_v,
            (std::vector<double>{0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 13, 13, 13}));
  for (int j = 0; j < 16; ++j) {
    const auto given = [&](int i) { return net.points[static_cast<std::size_t>(16 * j + i)]; };
    for (int i = 0; i < 16; ++i) EXPECT_EQ(s.point(i + 1, j), given(i));  // untouched
    EXPECT_EQ(s.point(0, j), Vec3(0.5 * (given(15) + given(0))));
    EXPECT_EQ(s.point(17, j), s.point(0, j));
  }
}

TEST(GridTest, VolumeOfAPrismIsAreaTimesLength) {
  for (int sections : {2, 3, 4, 9}) {
    Body body;
    ASSERT_TRUE(fill_from_grid(body, bar(sections, 12)).ok());
    EXPECT_EQ(body.surface.degree_v, std::min(3, sections - 1));
    ASSERT_TRUE(finish(body, EndStyle::patch).ok());
    // Area of the closed quadratic over a regular polygon: that of the polygon of its edges' midpoints, and
    // of each corner triangle (midpoint, control point, midpoint) the two thirds that lie under a parabola
    // (Archimedes).
    const double n = 12, c = std::cos(pi / n), s = std::sin(pi / n);
    const double midpoints = 0.5 * n * c * c * std::sin(2 * pi / n);
    const double triangle = c * s * (1 - c * c);  // half the base c s times the height 1 - c^2
    const double expected = midpoints + n * 2.0 / 3.0 * triangle;
    EXPECT_NEAR(body.volume, expected * 3.0, 1e-12) << sections;
    EXPECT_FALSE(body.inward);
  }
}

TEST(GridTest, TheOtherWayRoundIsTakenAsItIsAndMarked) {
  GridNet net = bar(4, 8);
  for (std::size_t j = 0; j < 4; ++j)
    std::reverse(net.points.begin() + static_cast<std::ptrdiff_t>(8 * j),
                 net.points.begin() + static_cast<std::ptrdiff_t>(8 * j + 8));
  Body body;
  ASSERT_TRUE(fill_from_grid(body, net).ok());
  ASSERT_TRUE(finish(body, EndStyle::patch).ok());
  EXPECT_TRUE(body.inward);
  EXPECT_GT(body.volume, 0.0);
  EXPECT_NEAR(body.start.normal.x(), -1.0, 1e-12);
  EXPECT_NEAR(body.end.normal.x(), 1.0, 1e-12);
  EXPECT_EQ(body.surface.point(1, 0), net.points[0]);
}

TEST(GridTest, OpenRoundTakesTheClampedForm) {
  Body closed, open;
  ASSERT_TRUE(fill_from_grid(closed, bar(5, 8)).ok());
  GridNet net;
  net.sections = 5;
  net.per_section = closed.surface.count_u;
  net.points = closed.surface.points;
  net.open_round = true;
  net.knots_round = closed.surface.knots_u;
  net.knots_along = closed.surface.knots_v;
  net.degree_round = 2;
  ASSERT_TRUE(fill_from_grid(open, net).ok());
  EXPECT_EQ(open.surface.points, closed.surface.points);
  EXPECT_EQ(open.surface.knots_u, closed.surface.knots_u);
  net.points.back() += Vec3(0, 0, 1e-9);
  EXPECT_FALSE(fill_from_grid(open, net).ok());
}

TEST(GridTest, WeightsMakeAnExactCylinder) {
  // Nine-point rational quadratic circle, clamped form.
  GridNet net;
  net.sections = 2;
  net.per_section = 9;
  net.open_round = true;
  net.degree_round = 2;
  net.knots_round = {0, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1};
  const std::vector<Vec2> square = {{1, 0},   {1, 1},  {0, 1},  {-1, 1}, {-1, 0},
                                    {-1, -1}, {0, -1}, {1, -1}, {1, 0}};
  for (int j = 0; j < 2; ++j)
    for (std::size_t i = 0; i < 9; ++i) {
      net.points.emplace_back(2.0 * j, square[i].x(), square[i].y());
      net.weights.push_back(i % 2 == 0 ? 1.0 : std::sqrt(0.5));
    }
  for (EndStyle ends : {EndStyle::patch, EndStyle::fan, EndStyle::planar}) {
    Body body;
    ASSERT_TRUE(fill_from_grid(body, net).ok());
    const Status s = finish(body, ends);
    ASSERT_TRUE(s.ok()) << to_string(s.error());
    EXPECT_NEAR(body.volume, 2 * pi, 1e-9);
    EXPECT_LT(end_gap(body, false), 1e-14);
  }
}

TEST(GridTest, RingOfSectionsClosesSmoothly) {
  GridNet net;
  net.sections = 24;
  net.per_section = 12;
  net.closed_along = true;
  for (int j = 0; j < 24; ++j)
    for (int i = 0; i < 12; ++i) {
      const double a = 2 * pi * j / 24, b = 2 * pi * (i + 0.5) / 12, r = 5 + std::cos(b);
      net.points.emplace_back(r * std::sin(a), r * std::cos(a), std::sin(b));
    }
  Body body;
  ASSERT_TRUE(fill_from_grid(body, net).ok());
  EXPECT_TRUE(body.closed_along);
  const double first = body.surface.first_v(), last = body.surface.last_v();
  for (double u : {0.0, 0.3, 0.9}) {
    const nurbs::SurfaceJet a = nurbs::evaluate_jet(body.surface, u, first),
                            b = nurbs::evaluate_jet(body.surface, u, last);
    EXPECT_EQ(a.position, b.position);
    EXPECT_LT((a.dv - b.dv).norm(), 1e-12);
  }
  ASSERT_TRUE(finish(body, EndStyle::patch).ok());
  EXPECT_EQ(body.start.style, EndStyle::none);
  // The control torus shrinks: by the mean of the basis on a circle, (2 + cos)/3 along.
  EXPECT_NEAR(body.volume, 2 * pi * pi * 5, 0.1 * 2 * pi * pi * 5);
}

TEST(GridTest, ImpossibleGridsAreRefused) {
  Body body;
  EXPECT_FALSE(fill_from_grid(body, bar(2, 2)).ok());
  GridNet net = bar(4, 8);
  net.degree_along = 5;
  EXPECT_FALSE(fill_from_grid(body, net).ok());
  net = bar(4, 8);
  net.knots_along = {0, 0, 0, 0, 1, 1, 1};
  EXPECT_FALSE(fill_from_grid(body, net).ok());
  net.knots_along = {0, 0, 0, 1, 1, 1, 1, 1};
  EXPECT_FALSE(fill_from_grid(body, net).ok());
  net = bar(4, 8);
  net.knots_round = {0, 0, 0, 1, 1, 1};
  EXPECT_FALSE(fill_from_grid(body, net).ok());
}

}  // namespace
}  // namespace selvage::yarn
