// Faces whose loops say no more than the surface does, and faces whose loops do.
#include "cad/natural_border.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cad/border.h"
#include "cad/sampled_curve.h"
#include "nurbs/restrict.h"
#include "unit/cad/surfaces.h"

namespace selvage::test {

namespace {

using cad::Edge;
using cad::Face;
using cad::Loop;

// A bent patch of degrees 3 and 2 over [0, 2] x [0, 3].
nurbs::Surface patch() {
  nurbs::Surface surface;
  surface.degree_u = 3;
  surface.degree_v = 2;
  surface.count_u = 5;
  surface.count_v = 5;
  surface.knots_u = {0, 0, 0, 0, 1, 2, 2, 2, 2};
  surface.knots_v = {0, 0, 0, 1, 2, 3, 3, 3};
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 5; ++i) surface.points.emplace_back(i, 1.5 * j, 0.2 * ((3 * i + 5 * j) % 4));
  return surface;
}

// A cylinder of radius 1 and height 3, exact: u round it from 0 to 4.
nurbs::Surface unit_cylinder() {
  return stretched(test::cylinder(1, 3), 4, 0);
}

Loop without_flats(Loop loop) {
  for (Edge& edge : loop.edges) edge.flat = {};
  return loop;
}
Loop without_curves(Loop loop) {
  for (Edge& edge : loop.edges) edge.curve = {};
  return loop;
}

Face bordered_face(const nurbs::Surface& surface, std::vector<Loop> loops) {
  Face face;
  face.surface = surface;
  face.loops = std::move(loops);
  return face;
}

TEST(NaturalBorder, ItsOwnBorderIsOne) {
  for (const nurbs::Surface& surface : {patch(), unit_cylinder()}) {
    const Loop border = cad::natural_border(surface, 1e-9);
    ASSERT_EQ(border.edges.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
      const nurbs::Curve &a = border.edges[i].curve, &b = border.edges[(i + 1) % 4].curve;
      EXPECT_EQ(a.points.back(), b.points.front());
      const Vec3 middle = nurbs::evaluate(border.edges[i].flat, border.edges[i].flat.knots[1]);
      EXPECT_LT((nurbs::evaluate(surface, middle.x(), middle.y()) - a.points.front()).norm(), 1e-14);
    }
    EXPECT_TRUE(cad::has_natural_border(bordered_face(surface, {border}), 1e-9));
    EXPECT_TRUE(cad::has_natural_border(bordered_face(surface, {without_flats(border)}), 1e-9));
    EXPECT_TRUE(cad::has_natural_border(bordered_face(surface, {without_curves(border)}), 1e-9));
  }
}

// Edges cut at other places than the sides, run the other way round, and of another degree.
TEST(NaturalBorder, OtherEdgesAlongTheSameWay) {
  Loop border = without_flats(cad::natural_border(patch(), 1e-9));
  Loop cut;
  for (auto edge = border.edges.rbegin(); edge != border.edges.rend(); ++edge) {
    const nurbs::Curve back = nurbs::reversed(edge->curve);
    const double t0 = back.first_parameter(), t1 = back.last_parameter(), t = t0 + 0.3 * (t1 - t0);
    cut.edges.push_back({nurbs::restricted(back, t0, t), {}, -1});
    cut.edges.push_back({nurbs::restricted(back, t, t1), {}, -1});
  }
  std::rotate(cut.edges.begin(), cut.edges.begin() + 3, cut.edges.end());
  Face face = bordered_face(patch(), {cut});
  EXPECT_TRUE(cad::drop_natural_border(face, 1e-9));
  EXPECT_TRUE(face.loops.empty());
}

TEST(NaturalBorder, ATubeWithItsRimsAndWithoutItsSeam) {
  const Loop border = without_flats(cad::natural_border(unit_cylinder(), 1e-9));
  const Loop first{{border.edges[0]}}, last{{border.edges[2]}};
  EXPECT_TRUE(cad::has_natural_border(bordered_face(unit_cylinder(), {first, last}), 1e-9));
  EXPECT_FALSE(cad::has_natural_border(bordered_face(unit_cylinder(), {first}), 1e-9));
}

// A bent tube with sharp edges: a flat hexagon, 1 x 0.4, sides of unequal lengths, degree 2; the path is
// cubic.
nurbs::Surface hexagonal_tube() {
  const double x[] = {0.5, 0.2, -0.3, -0.5, -0.2, 0.3, 0.5}, y[] = {0, 0.2, 0.2, 0, -0.2, -0.2, 0};
  nurbs::Surface surface;
  surface.degree_u = 2;
  surface.degree_v = 3;
  surface.count_u = 13;
  surface.count_v = 5;
  surface.knots_u = {0, 0, 0, 0.16, 0.16, 0.38, 0.38, 0.5, 0.5, 0.66, 0.66, 0.88, 0.88, 1, 1, 1};
  surface.knots_v = {0, 0, 0, 0, 0.5, 1, 1, 1, 1};
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 13; ++i) {
      const int a = i / 2, b = (i + 1) / 2;
      surface.points.emplace_back((x[a] + x[b]) / 2, (y[a] + y[b]) / 2 + 0.1 * (j % 3), 0.8 * j);
    }
  return surface;
}

// The edges of `curve` between these shares of its parameters.
std::vector<Edge> cut(const nurbs::Curve& curve, const std::vector<double>& shares) {
  const double t0 = curve.first_parameter(), length = curve.last_parameter() - t0;
  std::vector<Edge> edges;
  for (std::size_t i = 0; i + 1 < shares.size(); ++i)
    edges.push_back({nurbs::restricted(curve, t0 + shares[i] * length, t0 + shares[i + 1] * length), {}, -1});
  return edges;
}

// As solids have it: rims in four edges, whose points are not the surface's samples, and a seam used twice.
// The last points before the rim closes are nearest to its beginning, but not on its first piece.
TEST(NaturalBorder, ATubeWithItsRimsInFourEdges) {
  for (const nurbs::Surface& surface : {unit_cylinder(), hexagonal_tube()})
    for (const std::vector<double>& shares :
         {std::vector<double>{0, 0.25, 0.5, 0.75, 1}, {0, 0.16, 0.5, 0.66, 1}, {0, 0.01, 0.02, 0.97, 1}}) {
      SCOPED_TRACE(shares[1]);
      const Loop border = without_flats(cad::natural_border(surface, 1e-9));
      Loop loop;
      for (const std::size_t side : {0U, 2U}) {
        const std::vector<Edge> rim = cut(border.edges[side].curve, shares);
        loop.edges.insert(loop.edges.end(), rim.begin(), rim.end());
        loop.edges.push_back(border.edges[side + 1]);
      }
      EXPECT_TRUE(cad::has_natural_border(bordered_face(surface, {loop}), 1e-9));
      Loop without_last = loop;
      without_last.edges.erase(without_last.edges.begin() + 3);
      EXPECT_FALSE(cad::has_natural_border(bordered_face(surface, {without_last}), 1e-9));
      Loop moved = loop;
      for (Vec3& p : moved.edges[3].curve.points) p.z() += 1e-6;
      EXPECT_FALSE(cad::has_natural_border(bordered_face(surface, {moved}), 1e-7));
    }
}

// Every point of a closed curve is its own nearest one, also where the curve closes and next to its creases.
TEST(SampledCurve, FindsItsOwnPoints) {
  for (const nurbs::Surface& surface : {unit_cylinder(), hexagonal_tube()}) {
    const nurbs::Curve rim = cad::natural_border(surface, 1e-9).edges[0].curve;
    const cad::SampledCurve samples(rim);
    const double t0 = rim.first_parameter(), length = rim.last_parameter() - t0;
    for (int k = 0; k <= 1000; ++k) {
      const Vec3 p = nurbs::evaluate(rim, t0 + length * k / 1000);
      const auto found = samples.nearest(p);
      EXPECT_LT(found.distance, 1e-12) << k;
      EXPECT_LT((nurbs::evaluate(rim, found.parameter) - p).norm(), 1e-12) << k;
    }
  }
}

// A rim whose circle begins at another place than the surface's seam.
// A circle of three thirds has few points; the place nearest to the one next to its start lies behind its
// end.
TEST(Border, IsOneAcrossTheStartOfAClosedCurve) {
  nurbs::Curve circle;
  circle.degree = 2;
  circle.knots = {0, 0, 0, 1, 1, 2, 2, 3, 3, 3};
  for (int k = 0; k <= 6; ++k) {
    const double angle = std::numbers::pi / 3 * k, radius = k % 2 == 0 ? 50 : 100;
    circle.points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
    circle.weights.push_back(k % 2 == 0 ? 1 : 0.5);
  }
  circle.points.back() = circle.points.front();
  const cad::Border border(circle);
  for (int k = 0; k < 720; ++k) {
    const double angle = std::numbers::pi / 360 * k;
    for (const double radius : {50.0, 51.0, 49.0}) {
      const Vec3 p(radius * std::cos(angle), radius * std::sin(angle), 0.5);
      EXPECT_NEAR(border.distance(p, 0.3, 0, 1e9), std::hypot(radius - 50, 0.5), 1e-12) << k;
    }
  }
}

TEST(NaturalBorder, ARimThatBeginsElsewhere) {
  Loop first, last;
  for (const double z : {0.0, 3.0}) {
    nurbs::Curve circle = without_flats(cad::natural_border(unit_cylinder(), 1e-9)).edges[0].curve;
    for (Vec3& p : circle.points) p = Vec3(-p.y(), p.x(), z);
    (z == 0 ? first : last).edges.push_back({circle, {}, -1});
  }
  EXPECT_TRUE(cad::has_natural_border(bordered_face(unit_cylinder(), {first, last}), 1e-9));
}

TEST(NaturalBorder, WhatIsTrimmedStaysSo) {
  const Loop border = cad::natural_border(patch(), 1e-9);
  // A corner cut off.
  Loop corner = without_flats(border);
  nurbs::Curve& bottom = corner.edges[0].curve;
  bottom = nurbs::restricted(bottom, bottom.first_parameter(), 1.5);
  nurbs::Curve& right = corner.edges[1].curve;
  right = nurbs::restricted(right, 0.5, right.last_parameter());
  corner.edges.insert(corner.edges.begin() + 1, Edge{{.degree = 1,
                                                      .knots = {0, 0, 1, 1},
                                                      .points = {bottom.points.back(), right.points.front()},
                                                      .weights = {}},
                                                     {},
                                                     -1});
  EXPECT_FALSE(cad::has_natural_border(bordered_face(patch(), {corner}), 1e-9));
  // A side that is off by more than the tolerance, in the middle only.
  Loop bulge = without_flats(border);
  bulge.edges[3].curve.points[2].z() += 1e-3;
  EXPECT_FALSE(cad::has_natural_border(bordered_face(patch(), {bulge}), 1e-5));
  EXPECT_TRUE(cad::has_natural_border(bordered_face(patch(), {bulge}), 1e-3));
  // A hole beside the border.
  Loop hole;
  hole.edges.push_back({.curve = {},
                        .flat = {.degree = 1,
                                 .knots = {0, 0, 1, 2, 3, 3},
                                 .points = {{0.5, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0.5, 1, 0}},
                                 .weights = {}}});
  Face face = bordered_face(patch(), {border, hole});
  EXPECT_FALSE(cad::drop_natural_border(face, 1e-9));
  EXPECT_EQ(face.loops.size(), 2U);
  // One side twice instead of all four.
  EXPECT_FALSE(
      cad::has_natural_border(bordered_face(patch(), {Loop{{border.edges[0], border.edges[0]}}}), 1e-9));
}

// A fan: the last row is one point, the loop its rim alone, or with the seam and the pole.
TEST(NaturalBorder, Poles) {
  nurbs::Surface fan = unit_cylinder();
  for (int i = 0; i < 9; ++i) fan.point(i, 1) = Vec3(0, 0, 3);
  const Loop border = without_flats(cad::natural_border(fan, 1e-9));
  EXPECT_TRUE(border.edges[2].curve.points.empty());
  EXPECT_TRUE(cad::has_natural_border(bordered_face(fan, {border}), 1e-9));
  EXPECT_TRUE(cad::has_natural_border(bordered_face(fan, {Loop{{border.edges[0]}}}), 1e-9));
}

TEST(NaturalBorder, OpenKnots) {
  nurbs::Surface surface = patch();
  surface.knots_u = {-3, -2, -1, 0, 1, 2, 3, 4, 5};
  const Loop border = cad::natural_border(surface, 1e-9);
  for (const Edge& edge : border.edges) {
    const Vec3 flat = nurbs::evaluate(edge.flat, edge.flat.knots[1]);
    EXPECT_LT((nurbs::evaluate(surface, flat.x(), flat.y()) - edge.curve.points.front()).norm(), 1e-13);
  }
  EXPECT_TRUE(cad::has_natural_border(bordered_face(surface, {without_flats(border)}), 1e-9));
}

}  // namespace

}  // namespace selvage::test
