// Arcs, swept and analytic surfaces against their formulas.
#include "nurbs/conic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "nurbs/analytic.h"
#include "nurbs/chain.h"
#include "nurbs/measure.h"
#include "nurbs/power.h"
#include "nurbs/sweep.h"

namespace selvage::test {

namespace {

using nurbs::Analytic;
using nurbs::Curve;
using nurbs::Surface;
using std::numbers::pi;

const Vec3 center(1, 2, 3), along_x(3, 0, 0), along_y(0, 3, 0);

Curve segment(const Vec3& a, const Vec3& b) {
  return {.degree = 1, .knots = {0, 0, 1, 1}, .points = {a, b}, .weights = {}};
}

TEST(Conic, ACircleIsOne) {
  for (const double to : {0.3, pi / 2, 2.0, pi, 5.0, 2 * pi}) {
    const Curve arc = nurbs::elliptic_arc(center, along_x, along_y, 0, to);
    for (int i = 0; i <= 50; ++i) {
      const Vec3 p = nurbs::evaluate(arc, to * i / 50);
      EXPECT_NEAR((p - center).norm(), 3, 1e-14);
    }
    EXPECT_NEAR(nurbs::arc_length(arc), 3 * to, 1e-11);
    EXPECT_LT((arc.points.back() - center - std::cos(to) * along_x - std::sin(to) * along_y).norm(), 2e-15);
    for (const double angle : {0.1 * to, 0.37 * to, 0.5 * to, 0.99 * to}) {
      const double t = nurbs::parameter_at_angle(nurbs::arc_breaks(0, to), angle);
      const Vec3 p = nurbs::evaluate(arc, t) - center;
      const double found = std::atan2(p.y(), p.x());
      EXPECT_NEAR(std::remainder(found - angle, 2 * pi), 0, 1e-14);
    }
  }
  const Curve whole = nurbs::elliptic_arc(center, along_x, along_y, 1, 1 + 2 * pi);
  EXPECT_EQ(whole.points.front(), whole.points.back());
}

TEST(Conic, TheAngleAsParameter) {
  const Curve arc = nurbs::arc_by_angle(center, along_x, along_y, -1, 4);
  for (int i = 0; i <= 1000; ++i) {
    const double a = -1 + 0.005 * i;
    const Vec3 exact = center + std::cos(a) * along_x + std::sin(a) * along_y;
    EXPECT_LT((nurbs::evaluate(arc, a) - exact).norm(), 6e-11);
  }
}

TEST(Conic, EllipsesOfAnyPlacement) {
  // x'^2 / 9 + y'^2 / 4 = 1, turned by 0.4, moved to (5, -2).
  const double c = std::cos(0.4), s = std::sin(0.4);
  const auto point = [&](double a) {
    const double x = 3 * std::cos(a), y = 2 * std::sin(a);
    return Vec2(5 + c * x - s * y, -2 + s * x + c * y);
  };
  const double xx = c * c / 9 + s * s / 4, yy = s * s / 9 + c * c / 4, xy = 2 * c * s * (1.0 / 9 - 1.0 / 4);
  const double d = -2 * xx * 5 - xy * -2, e = -2 * yy * -2 - xy * 5;
  const double f = xx * 25 + xy * 5 * -2 + yy * 4 - 1;
  for (const double factor : {1.0, -7.0}) {
    const nurbs::ConicArc arc =
        nurbs::conic_arc({factor * xx, factor * xy, factor * yy, factor * d, factor * e, factor * f}, 1.5,
                         point(2.0), point(1.0));
    ASSERT_TRUE(arc.curve) << arc.fault;
    for (int i = 0; i <= 40; ++i) {
      const double t = std::lerp(arc.curve->first_parameter(), arc.curve->last_parameter(), i / 40.0);
      const Vec3 p = nurbs::evaluate(*arc.curve, t);
      const double value =
          xx * p.x() * p.x() + xy * p.x() * p.y() + yy * p.y() * p.y() + d * p.x() + e * p.y() + f;
      EXPECT_NEAR(value, 0, 1e-14);
      EXPECT_NEAR(p.z(), 1.5, 1e-15);
    }
    // Counter-clockwise from 2 to 1 radians is the long way round.
    double length = 0;
    for (int i = 0; i < 200000; ++i) {
      const double h = (2 * pi - 1) / 200000;
      length += (point(2 + h * (i + 1)) - point(2 + h * i)).norm();
    }
    EXPECT_NEAR(nurbs::arc_length(*arc.curve), length, 1e-9);
  }
}

TEST(Conic, HyperbolasAndParabolas) {
  // x^2 / 4 - y^2 = 1, its left branch.
  const double x = -std::sqrt(8.0);
  const nurbs::ConicArc left = nurbs::conic_arc({1, 0, -4, 0, 0, -4}, 0, {x, -1}, {x, 1});
  ASSERT_TRUE(left.curve) << left.fault;
  for (int i = 0; i <= 20; ++i) {
    const Vec3 p = nurbs::evaluate(*left.curve, i / 20.0);
    EXPECT_NEAR(p.x() * p.x() / 4 - p.y() * p.y(), 1, 1e-14);
    EXPECT_LT(p.x(), 0);
  }
  EXPECT_EQ(std::string(nurbs::conic_arc({1, 0, -4, 0, 0, -4}, 0, {x, -1}, {-x, 1}).fault),
            "its ends are on two branches of the hyperbola");
  // y = x^2 / 4; and (x + y)^2 = x - y, which is a turned one.
  const nurbs::ConicArc plain = nurbs::conic_arc({1, 0, 0, 0, -4, 0}, 0, {-2, 1}, {3, 2.25});
  ASSERT_TRUE(plain.curve) << plain.fault;
  for (int i = 0; i <= 20; ++i) {
    const Vec3 p = nurbs::evaluate(*plain.curve, i / 20.0);
    EXPECT_NEAR(p.y(), p.x() * p.x() / 4, 1e-14);
  }
  const auto on = [](double sum) { return Vec2((sum + sum * sum) / 2, (sum - sum * sum) / 2); };
  const nurbs::ConicArc turned = nurbs::conic_arc({1, 2, 1, -1, 1, 0}, 0, on(-1), on(2));
  ASSERT_TRUE(turned.curve) << turned.fault;
  for (int i = 0; i <= 20; ++i) {
    const Vec3 p = nurbs::evaluate(*turned.curve, i / 20.0);
    EXPECT_NEAR(std::pow(p.x() + p.y(), 2), p.x() - p.y(), 1e-13);
  }
}

TEST(Conic, WhatIsNone) {
  EXPECT_FALSE(nurbs::conic_arc({0, 0, 0, 1, 1, 0}, 0, {0, 0}, {1, -1}).curve);
  EXPECT_FALSE(nurbs::conic_arc({1, 0, 1, 0, 0, 1}, 0, {1, 0}, {0, 1}).curve);      // no real points
  EXPECT_FALSE(nurbs::conic_arc({1, 0, 1, 0, 0, -1}, 0, {1, 0}, {0, 1.01}).curve);  // off it
  EXPECT_FALSE(nurbs::conic_arc({1, 0, -1, 0, 0, 0}, 0, {1, 1}, {2, 2}).curve);     // two lines
}

TEST(Chain, PiecesKeepTheirPoints) {
  const std::vector<Curve> pieces = {
      segment({0, 0, 0}, {4, 2, 3}), nurbs::elliptic_arc(center, along_x, Vec3(0, 1, 1), 0, 3.5),
      segment(center + std::cos(3.5) * along_x + std::sin(3.5) * Vec3(0, 1, 1), {9, 9, 9})};
  EXPECT_LT(nurbs::largest_gap(pieces), 1e-14);
  const Curve whole = nurbs::chained(pieces);
  EXPECT_EQ(whole.knots.size(), whole.points.size() + static_cast<std::size_t>(whole.degree) + 1);
  double start = 0;
  for (const Curve& piece : pieces) {
    const double length = piece.last_parameter() - piece.first_parameter();
    for (int i = 0; i <= 20; ++i) {
      const double s = length * i / 20;
      EXPECT_LT(
          (nurbs::evaluate(whole, start + s) - nurbs::evaluate(piece, piece.first_parameter() + s)).norm(),
          1e-13);
    }
    start += length;
  }
}

TEST(Chain, CompatibleCurvesKeepTheirPoints) {
  Curve a = nurbs::elliptic_arc(center, along_x, along_y, 1, 4);
  Curve b;
  b.degree = 3;
  b.knots = {-2, -1, 0, 1, 2.5, 3, 4, 5, 6};
  b.points = {{0, 0, 0}, {1, 2, 0}, {3, 1, 1}, {4, 4, 4}, {5, 0, 1}};
  const Curve a0 = a, b0 = b;
  nurbs::make_compatible(a, b);
  EXPECT_EQ(a.knots, b.knots);
  EXPECT_EQ(a.degree, 3);
  for (int i = 0; i <= 60; ++i) {
    const double s = i / 60.0;
    EXPECT_LT((nurbs::evaluate(a, s) - nurbs::evaluate(a0, 1 + 3 * s)).norm(), 1e-13);
    EXPECT_LT((nurbs::evaluate(b, s) - nurbs::evaluate(b0, 1 + 2 * s)).norm(), 1e-13);
  }
}

TEST(Power, CurveAndSurface) {
  double gap = -1;
  const Curve curve = nurbs::from_power({0, 1, 3},
                                        {{{{0, 0, 1}, {1, 2, 0}, {0.5, 0, 0}, {0.25, -0.5, 0.5}}},
                                         {{{1.75, 1.5, 1.5}, {2, 1, 0}, {0, 1, 0}, {0.125, 0, -1}}}},
                                        &gap);
  EXPECT_LT(gap, 1e-15);
  for (const double t : {0.0, 0.25, 0.9, 1.0, 1.5, 2.75, 3.0}) {
    const double s = t < 1 ? t : t - 1;
    const Vec3 p =
        t < 1 ? Vec3(s + 0.5 * s * s + 0.25 * s * s * s, 2 * s - 0.5 * s * s * s, 1 + 0.5 * s * s * s)
              : Vec3(1.75 + 2 * s + 0.125 * s * s * s, 1.5 + s + s * s, 1.5 - s * s * s);
    EXPECT_LT((nurbs::evaluate(curve, t) - p).norm(), 1e-13);
  }
  nurbs::Bicubic patch{};
  for (auto& row : patch) row.fill(Vec3::Zero());
  patch[1][0] = {1, 0, 0};
  patch[0][1] = {0, 1, 0};
  patch[2][3] = {0, 0, 0.5};
  const Surface surface = nurbs::from_power({0, 2}, {0, 1.5}, {patch});
  for (const double u : {0.0, 0.7, 2.0})
    for (const double v : {0.0, 0.4, 1.5})
      EXPECT_LT((nurbs::evaluate(surface, u, v) - Vec3(u, v, 0.5 * u * u * v * v * v)).norm(), 1e-13);
}

TEST(Sweep, Volumes) {
  // By the divergence theorem; the flat ends of cylinder and cone add a third of height and area.
  const Vec3 none = Vec3::Zero();
  const Surface side = nurbs::revolved(segment({2, 0, 1}, {2, 0, 6}), none, {0, 0, 1}, 0, 2 * pi);
  EXPECT_NEAR(std::abs(nurbs::volume_flux(side, none)), 2.0 / 3 * pi * 4 * 5, 1e-10);
  for (int i = 0; i < side.count_u; ++i) EXPECT_EQ(side.point(i, 0), side.point(i, side.count_v - 1));
  const Surface tube = nurbs::extruded(nurbs::elliptic_arc(none, {2, 0, 0}, {0, 2, 0}, 0, 2 * pi), {0, 0, 5});
  EXPECT_NEAR(std::abs(nurbs::volume_flux(tube, none)), 2.0 / 3 * pi * 4 * 5, 1e-10);
  const Surface loft = nurbs::ruled(nurbs::elliptic_arc(none, {2, 0, 0}, {0, 2, 0}, 0, 2 * pi),
                                    nurbs::elliptic_arc({0, 0, 3}, {1, 0, 0}, {0, 1, 0}, 0, 2 * pi));
  EXPECT_NEAR(std::abs(nurbs::volume_flux(loft, none)), pi * 3 / 3 * (4 + 2 + 1) - pi * 1 * 3 / 3, 1e-10);
}

double size_of(const Analytic& shape) {
  return std::abs(nurbs::volume_flux(shape.part(shape.whole()), shape.origin));
}

TEST(Analytic, WholeOnes) {
  Analytic sphere = Analytic::placed(Analytic::Kind::sphere, center, {1, 1, 1}, Vec3::Zero());
  sphere.radius = 1.5;
  EXPECT_NEAR(size_of(sphere), 4.0 / 3 * pi * std::pow(1.5, 3), 1e-10);
  Analytic torus = Analytic::placed(Analytic::Kind::torus, center, {0, 1, 2}, {1, 0, 0});
  torus.radius = 4;
  torus.minor = 1.25;
  EXPECT_NEAR(size_of(torus), 2 * pi * pi * 4 * 1.25 * 1.25, 1e-10);
  // Outward: away from the centre, or from the core.
  for (const Analytic& shape : {sphere, torus}) {
    const Surface surface = shape.part(shape.whole());
    for (double u = 0.05; u < 6.2; u += 0.5)
      for (double v = surface.first_v() + 0.1; v < surface.last_v(); v += 0.4) {
        const nurbs::SurfaceJet jet = nurbs::evaluate_jet(surface, u, v);
        const Vec3 from_center = jet.position - shape.origin;
        const Vec3 flat = from_center - from_center.dot(shape.z) * shape.z;
        const bool is_torus = shape.kind == Analytic::Kind::torus;
        const Vec3 out = is_torus ? Vec3(from_center - 4 * flat.normalized()) : from_center;
        EXPECT_NEAR(out.norm(), is_torus ? 1.25 : 1.5, 1e-13);
        EXPECT_GT(jet.du.cross(jet.dv).dot(out), 0);
      }
  }
}

std::vector<Vec3> circle(const Analytic& shape, double height, double radius, double from, double to) {
  std::vector<Vec3> points;
  for (int i = 0; i <= 40; ++i) {
    const double a = from + (to - from) * i / 40;
    points.push_back(shape.origin + height * shape.z +
                     radius * (std::cos(a) * shape.x + std::sin(a) * shape.y));
  }
  return points;
}

TEST(Analytic, WhatLoopsBound) {
  Analytic cylinder = Analytic::placed(Analytic::Kind::cylinder, center, {0, 0, 1}, {1, 0, 0});
  cylinder.radius = 2;
  // Two rims that begin at 1 radian.
  auto range =
      cylinder.bounded_by({circle(cylinder, 1, 2, 1, 1 + 2 * pi), circle(cylinder, 4, 2, 1, 1 - 2 * pi)});
  ASSERT_TRUE(range);
  EXPECT_NEAR(range->u0, 1, 1e-12);
  EXPECT_NEAR(range->u1, 1 + 2 * pi, 1e-12);
  EXPECT_NEAR(range->v0, 1, 1e-12);
  EXPECT_NEAR(range->v1, 4, 1e-12);
  // A part across the angle pi.
  std::vector<Vec3> loop = circle(cylinder, 1, 2, 3, 4);
  for (const Vec3& p : circle(cylinder, 2, 2, 4, 3)) loop.push_back(p);
  range = cylinder.bounded_by({loop});
  ASSERT_TRUE(range);
  EXPECT_NEAR(range->u1 - range->u0, 1, 1e-12);
  const Surface part = cylinder.part(*range);
  for (const Vec3& p : part.points) EXPECT_LT(p.x(), center.x());
  EXPECT_FALSE(cylinder.bounded_by({circle(cylinder, 1, 2, 0, 2 * pi)}));  // the rest has no end
  // A cap of a sphere, bounded by one circle: above or below, as it runs.
  Analytic sphere = Analytic::placed(Analytic::Kind::sphere, center, {0, 0, 1}, {1, 0, 0});
  sphere.radius = 2;
  range = sphere.bounded_by({circle(sphere, 1, std::sqrt(3.0), 0, 2 * pi)});
  ASSERT_TRUE(range);
  EXPECT_EQ(range->v1, pi / 2);
  EXPECT_NEAR(range->v0, pi / 6, 1e-12);
  range = sphere.bounded_by({circle(sphere, 1, std::sqrt(3.0), 2 * pi, 0)});
  ASSERT_TRUE(range);
  EXPECT_EQ(range->v0, -pi / 2);
}

}  // namespace

}  // namespace selvage::test
