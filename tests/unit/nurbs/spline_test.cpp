// B-spline evaluation and editing against analytic answers and identities.
#include "nurbs/spline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "nurbs/basis.h"
#include "nurbs/jets.h"
#include "nurbs/restrict.h"

namespace selvage::nurbs {
namespace {

// A curve with uneven knots, one of them double, and, if asked, weights.
Curve wild_curve(int degree, bool rational) {
  std::mt19937 random(static_cast<unsigned>(degree) * 7 + (rational ? 1 : 0));
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  Curve curve;
  curve.degree = degree;
  const std::vector<double> inner = {0.5, 0.8, 1.7, 1.7, 3.0, 3.1};
  curve.knots.assign(static_cast<std::size_t>(degree) + 1, 0.25);
  curve.knots.insert(curve.knots.end(), inner.begin(), inner.end());
  curve.knots.insert(curve.knots.end(), static_cast<std::size_t>(degree) + 1, 4.0);
  const std::size_t count = curve.knots.size() - static_cast<std::size_t>(degree) - 1;
  for (std::size_t i = 0; i < count; ++i) {
    curve.points.emplace_back(value(random), value(random), value(random));
    if (rational) curve.weights.push_back(1.5 + value(random));
  }
  return curve;
}

// The textbook recursion (Cox-de Boor), slow and independent of basis().
double cox_de_boor(const std::vector<double>& knots, int i, int degree, double t) {
  const auto knot = [&](int k) { return knots[static_cast<std::size_t>(k)]; };
  if (degree == 0) return knot(i) <= t && t < knot(i + 1) ? 1.0 : 0.0;
  double value = 0.0;
  if (knot(i + degree) > knot(i))
    value += (t - knot(i)) / (knot(i + degree) - knot(i)) * cox_de_boor(knots, i, degree - 1, t);
  if (knot(i + degree + 1) > knot(i + 1))
    value += (knot(i + degree + 1) - t) / (knot(i + degree + 1) - knot(i + 1)) *
             cox_de_boor(knots, i + 1, degree - 1, t);
  return value;
}

TEST(Basis, IsTheCoxDeBoorRecursionAndSumsToOne) {
  for (int degree = 1; degree <= 5; ++degree) {
    const Curve curve = wild_curve(degree, false);
    const int count = static_cast<int>(curve.points.size());
    for (double t = 0.25; t < 4.0; t += 0.0173) {
      const int span = find_span(curve.knots, degree, count, t);
      BasisRow values{};
      basis(curve.knots, degree, span, t, values);
      double sum = 0.0;
      for (int j = 0; j <= degree; ++j) {
        sum += values[static_cast<std::size_t>(j)];
        EXPECT_NEAR(values[static_cast<std::size_t>(j)],
                    cox_de_boor(curve.knots, span - degree + j, degree, t), 1e-14);
      }
      EXPECT_NEAR(sum, 1.0, 1e-14);
    }
  }
}

TEST(Basis, GrevillePointsReproduceTheStraightLine) {
  Curve curve = wild_curve(3, false);
  const std::vector<double> sites = greville(curve.knots, 3, static_cast<int>(curve.points.size()));
  for (std::size_t i = 0; i < sites.size(); ++i) curve.points[i] = Vec3(sites[i], 2.0 * sites[i], -1.0);
  for (double t = 0.25; t <= 4.0; t += 0.1)
    EXPECT_LT((evaluate(curve, t) - Vec3(t, 2.0 * t, -1.0)).norm(), 1e-13);
}

TEST(Basis, GaussRuleIntegratesPolynomialsExactly) {
  for (int n = 1; n <= 10; ++n) {
    const GaussRule& rule = gauss_rule(n);
    for (int power = 0; power <= 2 * n - 1; ++power) {
      double sum = 0.0;
      for (std::size_t i = 0; i < rule.nodes.size(); ++i)
        sum += rule.weights[i] * std::pow(rule.nodes[i], power);
      EXPECT_NEAR(sum, power % 2 == 1 ? 0.0 : 2.0 / (power + 1), 1e-14) << n << " " << power;
    }
  }
}

TEST(CurveTest, DerivativesAgreeWithFiniteDifferences) {
  for (bool rational : {false, true}) {
    const Curve curve = wild_curve(3, rational);
    for (double t : {0.3, 0.6, 1.2, 2.2, 3.5}) {
      const double h = 1e-4;
      const CurveJet jet = evaluate_jet(curve, t);
      const Vec3 before = evaluate(curve, t - h), here = evaluate(curve, t), after = evaluate(curve, t + h);
      EXPECT_LT((jet.position - here).norm(), 1e-14);
      EXPECT_LT((jet.d1 - (after - before) / (2 * h)).norm(), 2e-5 * (1 + jet.d1.norm()));
      EXPECT_LT((jet.d2 - (after - 2 * here + before) / (h * h)).norm(), 1e-4 * (1 + jet.d2.norm()));
    }
  }
}

TEST(CurveTest, JetsOfManyPlacesAreThoseOfOne) {
  for (bool rational : {false, true})
    for (int degree = 1; degree <= 5; ++degree) {
      const Curve curve = wild_curve(degree, rational);
      const Jets jets(curve);
      for (double t = 0.0; t <= 4.3; t += 0.05) {
        const CurveJet jet = jets.at(t), one = evaluate_jet(curve, t);
        EXPECT_LT((jet.position - one.position).norm(), 1e-13) << degree << " at " << t;
        EXPECT_LT((jet.d1 - one.d1).norm(), 1e-12 * (1 + one.d1.norm())) << degree << " at " << t;
        EXPECT_LT((jet.d2 - one.d2).norm(), 1e-11 * (1 + one.d2.norm())) << degree << " at " << t;
      }
      for (const double end : {0.25, 4.0}) EXPECT_EQ(jets.at(end).position, evaluate(curve, end));
    }
}

TEST(CurveTest, KnotInsertionLeavesTheCurve) {
  for (bool rational : {false, true})
    for (int degree = 2; degree <= 4; ++degree) {
      const Curve curve = wild_curve(degree, rational);
      for (double knot : {0.4, 0.8, 1.7, 2.0}) {
        const Curve more = insert_knot(curve, knot, knot == 1.7 ? degree - 2 : degree - 1);
        ASSERT_EQ(more.knots.size(), more.points.size() + static_cast<std::size_t>(degree) + 1);
        for (double t = 0.25; t <= 4.0; t += 0.01)
          ASSERT_LT((evaluate(more, t) - evaluate(curve, t)).norm(), 1e-13)
              << degree << " " << knot << " " << t;
      }
    }
}

TEST(CurveTest, PartsAndTheReversedCurveAreTheCurve) {
  for (bool rational : {false, true}) {
    const Curve curve = wild_curve(3, rational);
    for (const auto& [t0, t1] :
         std::vector<std::pair<double, double>>{{0.25, 0.9}, {0.8, 1.7}, {1.0, 3.3}, {1.7, 4.0}}) {
      const Curve part = sub_curve(curve, t0, t1);
      ASSERT_EQ(part.knots.size(), part.points.size() + 4);
      EXPECT_EQ(part.first_parameter(), t0);
      EXPECT_EQ(part.last_parameter(), t1);
      for (double s = 0.0; s <= 1.0; s += 0.05) {
        const double t = t0 + s * (t1 - t0);
        EXPECT_LT((evaluate(part, t) - evaluate(curve, t)).norm(), 1e-12) << t0 << " " << t1 << " " << t;
      }
    }
    const Curve back = reversed(curve);
    for (double t = 0.25; t <= 4.0; t += 0.05)
      EXPECT_LT((evaluate(back, 4.25 - t) - evaluate(curve, t)).norm(), 1e-13);
  }
}

TEST(CurveTest, RationalQuadraticIsACircle) {
  Curve arc;
  arc.degree = 2;
  arc.knots = {0, 0, 0, 1, 1, 1};
  arc.points = {Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
  arc.weights = {1.0, std::sqrt(0.5), 1.0};
  for (double t = 0.0; t <= 1.0; t += 0.05) EXPECT_NEAR(evaluate(arc, t).norm(), 1.0, 1e-15);
}

Surface wild_surface(bool rational) {
  const Curve round = wild_curve(2, false), along = wild_curve(3, false);
  Surface surface;
  surface.degree_u = 2;
  surface.degree_v = 3;
  surface.knots_u = round.knots;
  surface.knots_v = along.knots;
  surface.count_u = static_cast<int>(round.points.size());
  surface.count_v = static_cast<int>(along.points.size());
  std::mt19937 random(5);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  for (int k = 0; k < surface.count_u * surface.count_v; ++k) {
    surface.points.emplace_back(value(random), value(random), value(random));
    if (rational) surface.weights.push_back(1.5 + value(random));
  }
  return surface;
}

TEST(SurfaceTest, GridJetAndTensorProductAgree) {
  for (bool rational : {false, true}) {
    const Surface surface = wild_surface(rational);
    const std::vector<double> us = {0.25, 0.77, 2.0, 4.0}, vs = {0.25, 0.6, 1.7, 3.05, 4.0};
    const std::vector<Vec3> grid = evaluate_grid(surface, us, vs);
    for (std::size_t j = 0; j < vs.size(); ++j)
      for (std::size_t i = 0; i < us.size(); ++i) {
        Vec3 sum = Vec3::Zero();
        double total = 0.0;
        for (int b = 0; b < surface.count_v; ++b)
          for (int a = 0; a < surface.count_u; ++a) {
            // Half-open recursion: the very end of the domain is taken from just inside.
            const double share = cox_de_boor(surface.knots_u, a, 2, std::min(us[i], 4.0 - 1e-13)) *
                                 cox_de_boor(surface.knots_v, b, 3, std::min(vs[j], 4.0 - 1e-13)) *
                                 surface.weight(a, b);
            sum += share * surface.point(a, b);
            total += share;
          }
        EXPECT_LT((grid[j * us.size() + i] - sum / total).norm(), 1e-11);
        EXPECT_LT((evaluate_jet(surface, us[i], vs[j]).position - grid[j * us.size() + i]).norm(), 1e-13);
        EXPECT_LT((evaluate(row_at(surface, vs[j]), us[i]) - grid[j * us.size() + i]).norm(), 1e-13);
      }
    const double h = 1e-5;
    const SurfaceJet jet = evaluate_jet(surface, 1.1, 2.2);
    const Vec3 du = (evaluate(surface, 1.1 + h, 2.2) - evaluate(surface, 1.1 - h, 2.2)) / (2 * h);
    const Vec3 dv = (evaluate(surface, 1.1, 2.2 + h) - evaluate(surface, 1.1, 2.2 - h)) / (2 * h);
    EXPECT_LT((jet.du - du).norm(), 1e-7);
    EXPECT_LT((jet.dv - dv).norm(), 1e-7);
  }
}

TEST(SurfaceTest, BoundaryRowIsTheBoundary) {
  const Surface surface = wild_surface(true);
  for (bool last : {false, true}) {
    const Curve row = boundary_row(surface, last);
    for (double u = 0.25; u <= 4.0; u += 0.1)
      EXPECT_LT((evaluate(row, u) - evaluate(surface, u, last ? 4.0 : 0.25)).norm(), 1e-13);
  }
}

}  // namespace
}  // namespace selvage::nurbs
