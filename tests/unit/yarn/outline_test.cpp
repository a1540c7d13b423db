// Section outlines against their analytic shapes.
#include "yarn/outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "yarn/ends.h"

namespace selvage::yarn {
namespace {

using std::numbers::pi;

nurbs::Curve curve_of(const Outline& outline) {
  nurbs::Curve curve{outline.degree, outline.knots, {}, {}};
  for (const Vec2& p : outline.points) curve.points.emplace_back(p.x(), p.y(), 0.0);
  return curve;
}

// The exact shape as many points, by definitions of their own.
std::vector<Vec2> exact_points(const Section& section, const SectionSize& s, int n = 40000) {
  std::vector<Vec2> points;
  const double a = s.width / 2, h = s.height / 2;
  for (int i = 0; i < n; ++i) {
    const double t = 2 * pi * i / n;
    if (std::holds_alternative<Lenticular>(section)) {
      const double y_centre = (h * h - a * a) / (2 * h),
                   radius = h - y_centre;  // circle through (a,0), (0,h), (-a,0)
      const double x = a * std::cos(t);
      const double y = y_centre + std::sqrt(std::max(0.0, radius * radius - x * x));
      points.emplace_back(x, t < pi ? y : -y);
    } else if (std::holds_alternative<Racetrack>(section)) {
      const double r = std::min(a, h);
      // March round by length.
      const double straight_x = 2 * (a - r), straight_y = 2 * (h - r),
                   total = 2 * pi * r + 2 * straight_x + 2 * straight_y;
      double run = total * i / n;
      const auto corner = [&](double cx, double cy, double from) {
        const double angle = from + run / r;
        points.emplace_back(cx + r * std::cos(angle), cy + r * std::sin(angle));
      };
      const double q = pi / 2 * r;
      if (run < q)
        corner(a - r, h - r, 0);
      else if ((run -= q) < straight_x)
        points.emplace_back(a - r - run, h);
      else if ((run -= straight_x) < q)
        corner(-(a - r), h - r, pi / 2);
      else if ((run -= q) < straight_y)
        points.emplace_back(-a, h - r - run);
      else if ((run -= straight_y) < q)
        corner(-(a - r), -(h - r), pi);
      else if ((run -= q) < straight_x)
        points.emplace_back(-(a - r) + run, -h);
      else if ((run -= straight_x) < q)
        corner(a - r, -(h - r), 1.5 * pi);
      else
        points.emplace_back(a, -(h - r) + (run - q));
    } else {
      const auto* power = std::get_if<Power>(&section);
      const double e = power != nullptr ? power->exponent : 1.0;
      points.emplace_back(a * std::cos(t),
                          h * std::copysign(std::pow(std::abs(std::sin(t)), e), std::sin(t)));
    }
  }
  return points;
}

double nearest(const std::vector<Vec2>& cloud, const Vec2& p) {
  double best = 1e300;
  for (const Vec2& q : cloud) best = std::min(best, (p - q).squaredNorm());
  return std::sqrt(best);
}

struct Case {
  Section section;
  SectionSize size;
};
const std::vector<Case> cases = {{Circle{1.0}, {1, 1}},
                                 {Ellipse{0.8, 0.2}, {0.8, 0.2}},
                                 {Lenticular{1.7, 0.14}, {1.7, 0.14}},
                                 {Racetrack{1.4, 0.16}, {1.4, 0.16}},
                                 {Racetrack{0.2, 0.9}, {0.2, 0.9}},
                                 {Power{1, 0.4, 0.5}, {1, 0.4}},
                                 {Power{1, 0.4, 1.5}, {1, 0.4}},
                                 {Power{1, 0.4, 2}, {1, 0.4}},
                                 {Power{1, 0.4, 3}, {1, 0.4}}};

TEST(OutlineTest, StaysWithinItsBoundAndTheBoundIsNotLoose) {
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const auto& [section, size] = cases[k];
    const std::vector<Vec2> cloud = exact_points(section, size);
    double before = 1e300;
    for (int pieces : {4, 8}) {
      const Outline outline = make_outline(section, size, pieces, false);
      const nurbs::Curve curve = curve_of(outline);
      ASSERT_EQ(curve.knots.size(), curve.points.size() + static_cast<std::size_t>(curve.degree) + 1);
      EXPECT_EQ(curve.points.front(), curve.points.back());
      const double bound = outline_error(section, size, outline);
      double measured = 0.0;
      for (int i = 0; i < 400; ++i) {
        const Vec3 p = nurbs::evaluate(curve, i / 400.0);
        measured = std::max(measured, nearest(cloud, {p.x(), p.y()}));
      }
      const double cloud_spacing = 2e-4;  // of 40000 points round
      EXPECT_LE(measured, bound + cloud_spacing) << "case " << k << " pieces " << pieces;
      EXPECT_LT(bound, 2.5 * measured + cloud_spacing) << "case " << k << " pieces " << pieces;
      EXPECT_LT(bound, std::max(0.7 * before, 1e-13)) << "case " << k;  // exponent 2 is a parabola: exact
      before = bound;
    }
  }
}

TEST(OutlineTest, AreaIsTheAnalyticOne) {
  EXPECT_NEAR(area(Circle{}, {2, 2}), pi, 1e-15);
  EXPECT_NEAR(area(Power{1, 1, 1}, {0.8, 0.2}), pi / 4 * 0.16, 1e-12);
  for (const auto& [section, size] : cases) {
    // Shoelace of the exact points, by another way than the closed formula.
    const std::vector<Vec2> p = exact_points(section, size);
    double sum = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Vec2 &a = p[i], &b = p[(i + 1) % p.size()];
      sum += 0.5 * (a.x() * b.y() - a.y() * b.x());
    }
    EXPECT_NEAR(area(section, size), sum, 2e-5 * sum);
  }
}

TEST(OutlineTest, EllipseHasItsExactAreaAndUniformKnots) {
  const Outline outline = make_outline(Ellipse{0.8, 0.2}, {0.8, 0.2}, 4, false);
  EXPECT_NEAR(area_vector(curve_of(outline)).z(), pi / 4 * 0.16, 1e-15);
  ASSERT_EQ(outline.points.size(), 19U);  // 16 different ones, the first three once more, cut open
  for (int i = 1; i < 16; ++i) EXPECT_DOUBLE_EQ(outline.knots[static_cast<std::size_t>(i + 3)], i / 16.0);
}

// A cubic through the values (4 + 2 cos h) / 6 of its polygon's radius at the knots, h = 2 pi / n, and
// (23 cos(h/2) + cos(3h/2)) / 24 between them, brought to the circle's area: the half of their difference.
TEST(OutlineTest, CirclesAreRoundAsPeriodicCubicsAre) {
  for (const int points : {8, 12, 16, 24}) {
    const double h = 2 * pi / points;
    const double knot = (4 + 2 * std::cos(h)) / 6, middle = (23 * std::cos(h / 2) + std::cos(3 * h / 2)) / 24;
    const double found = outline_error(Circle{1}, {1, 1}, make_outline(Circle{1}, {1, 1}, points / 4, false));
    EXPECT_NEAR(found, 0.5 * std::abs(knot - middle) / (knot + middle), 0.2 * found) << points;
  }
}

TEST(OutlineTest, SharpTipsAreThere) {
  const Outline lens = make_outline(Lenticular{2, 0.5}, {2, 0.5}, 4, false);
  const nurbs::Curve curve = curve_of(lens);
  EXPECT_EQ(nurbs::evaluate(curve, 0.0), Vec3(1, 0, 0));
  EXPECT_LT((nurbs::evaluate(curve, 0.5) - Vec3(-1, 0, 0)).norm(), 1e-15);
  EXPECT_EQ(std::count(lens.knots.begin(), lens.knots.end(), 0.5), 2);
  // Knots do not depend on the size: sections of one yarn can differ in size.
  EXPECT_EQ(lens.knots, make_outline(Lenticular{2, 0.5}, {1.1, 0.6}, 4, true).knots);
  EXPECT_EQ(make_outline(Racetrack{2, 0.5}, {2, 0.5}, 4, true).knots,
            make_outline(Racetrack{2, 0.5}, {1.1, 0.6}, 4, true).knots);
}

TEST(OutlineTest, PolygonIsItself) {
  const Polygon clockwise{{{0, 0.5}, {1, 0}, {0, -0.5}, {-1, 0}}};
  const Outline outline = make_outline(clockwise, nominal_size(clockwise), 1, false);
  EXPECT_NEAR(area_vector(curve_of(outline)).z(), 1.0, 1e-15);  // counter-clockwise whatever the file's order
  EXPECT_EQ(outline.points.front(), Vec2(1, 0));
  EXPECT_EQ(outline_error(clockwise, nominal_size(clockwise), outline), 0.0);
  const Polygon triangle{{{0, 0}, {1, 0}, {0, 1}}};
  const Outline three = make_outline(triangle, nominal_size(triangle), 1, false);
  EXPECT_NEAR(area_vector(curve_of(three)).z(), 0.5, 1e-15);
}

TEST(OutlineTest, SevenPointSectionHasTheNominalMeanRadius) {
  // The uniform cubic on a control square: radius 2/3 of the circle's at the knots, 11/24 sqrt 2 between
  // them.
  const double ratio = (2.0 / 3.0 - 11.0 / 24.0 * std::sqrt(2.0)) / (2.0 / 3.0);
  EXPECT_NEAR(loop7_out_of_roundness(), ratio, 0.02 * ratio);
  const double round = area(Loop7{1}, {1, 1});
  EXPECT_NEAR(round, pi / 4, 2e-4);
}

TEST(OutlineTest, ImpossibleSectionsAreRefused) {
  EXPECT_FALSE(check_section(Ellipse{1, 0}, {1, 0}).ok());
  EXPECT_FALSE(check_section(Power{1, 1, 20}, {1, 1}).ok());
  EXPECT_FALSE(check_section(Polygon{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}}, {1, 1}).ok());  // a bow tie
  EXPECT_FALSE(check_section(Polygon{{{0, 0}, {1, 1}}}, {1, 1}).ok());
  EXPECT_TRUE(check_section(Lenticular{1.7, 0.14}, {1.7, 0.14}).ok());
}

}  // namespace
}  // namespace selvage::yarn
