#include "nurbs/bezier.h"

#include <algorithm>
#include <cmath>

#include "core/plane.h"
#include "nurbs/basis.h"
#include "nurbs/roots.h"

namespace selvage::nurbs {

namespace {

// The roots of a t^2 + b t + c inside (0, 1), without loss of digits where b^2 is large.
std::vector<double> inner_roots(double a, double b, double c) {
  std::vector<double> roots;
  const auto keep = [&roots](double numerator, double denominator) {
    const double root = numerator / denominator;
    if (root > 0.0 && root < 1.0) roots.push_back(root);  // false for what is not finite
  };
  const double discriminant = b * b - 4.0 * a * c;
  if (discriminant < 0.0) return roots;
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  keep(q, a);
  keep(c, q);
  return roots;
}

// Of a span: the cubic with its ends and end derivatives between two parameters, or halves of it.
void add_cubics(const Curve& span, double t0, double t1, double tolerance, int halvings,
                std::vector<Bezier>& cubics) {
  constexpr int most_halvings = 16;
  const CurveJet from = evaluate_jet(span, t0), to = evaluate_jet(span, t1);
  const Vec2 p0 = from.position.head<2>(), p3 = to.position.head<2>();
  const Bezier made = {p0, p0 + (t1 - t0) / 3.0 * from.d1.head<2>(), p3 - (t1 - t0) / 3.0 * to.d1.head<2>(),
                       p3};
  double off = 0.0;
  for (const double share : {0.25, 0.5, 0.75}) {
    const Vec2 there = evaluate(span, t0 + share * (t1 - t0)).head<2>();
    off = std::max(off, (evaluate(made, share) - there).norm());
  }
  const bool is_exact = !span.is_rational() && span.degree <= 3;
  if (is_exact || off <= tolerance || halvings == most_halvings) return cubics.push_back(made);
  const double middle = 0.5 * (t0 + t1);
  add_cubics(span, t0, middle, tolerance, halvings + 1, cubics);
  add_cubics(span, middle, t1, tolerance, halvings + 1, cubics);
}

}  // namespace

Bezier straight_bezier(const Vec2& from, const Vec2& to) {
  return {from, from + (to - from) / 3.0, to - (to - from) / 3.0, to};
}

Vec2 evaluate(const Bezier& curve, double t) {
  const double s = 1.0 - t;
  return s * s * s * curve[0] + 3.0 * t * s * s * curve[1] + 3.0 * t * t * s * curve[2] +
         t * t * t * curve[3];
}

Vec2 derivative(const Bezier& curve, double t) {
  const double s = 1.0 - t;
  return 3.0 * (s * s * (curve[1] - curve[0]) + 2.0 * s * t * (curve[2] - curve[1]) +
                t * t * (curve[3] - curve[2]));
}

Box2 bounds(const Bezier& curve) {
  Box2 box(curve[0]);
  box.extend(curve[3]);
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    const double d0 = curve[1][axis] - curve[0][axis], d1 = curve[2][axis] - curve[1][axis],
                 d2 = curve[3][axis] - curve[2][axis];
    for (double t : inner_roots(d0 - 2.0 * d1 + d2, 2.0 * (d1 - d0), d0)) box.extend(evaluate(curve, t));
  }
  return box;
}

double swept_area(const Bezier& curve, const Vec2& origin) {
  const GaussRule& rule = gauss_rule(3);
  double sum = 0.0;
  for (std::size_t g = 0; g < rule.nodes.size(); ++g) {
    const double t = 0.5 * (1.0 + rule.nodes[g]);
    const Vec2 p = evaluate(curve, t) - origin, d = derivative(curve, t);
    sum += 0.5 * rule.weights[g] * cross(p, d);
  }
  return 0.5 * sum;
}

std::vector<Bezier> cubics_of(const Curve& curve, double tolerance) {
  const auto at = [](const Curve& of, std::size_t i) -> Vec2 { return of.points[i].head<2>(); };
  const std::vector<double> knots = breakpoints(curve.knots, curve.degree);
  std::vector<Bezier> cubics;
  for (std::size_t k = 1; k < knots.size(); ++k) {
    const Curve span = knots.size() == 2 ? curve : sub_curve(curve, knots[k - 1], knots[k]);
    if (curve.degree == 1 && !curve.is_rational())
      cubics.push_back(straight_bezier(at(span, 0), at(span, 1)));
    else if (curve.degree == 3 && !curve.is_rational())
      cubics.push_back({at(span, 0), at(span, 1), at(span, 2), at(span, 3)});
    else
      add_cubics(span, knots[k - 1], knots[k], tolerance, 0, cubics);
  }
  for (std::size_t k = 1; k < cubics.size(); ++k) cubics[k].front() = cubics[k - 1].back();
  cubics.front().front() = at(curve, 0);
  cubics.back().back() = at(curve, curve.points.size() - 1);
  return cubics;
}

Turning turning(const Bezier& curve) {
  constexpr int steps = 16;  // of less than half a turn each
  const Vec2 d0 = curve[1] - curve[0], d1 = curve[2] - curve[1], d2 = curve[3] - curve[2];
  // B' x B'' / 18 = c01 s^2 + c02 s t + c12 t^2
  const double c01 = cross(d0, d1), c02 = cross(d0, d2), c12 = cross(d1, d2);
  std::vector<double> ends = inner_roots(c01 - c02 + c12, c02 - 2.0 * c01, c01);
  ends.push_back(0.0);
  ends.push_back(1.0);
  std::ranges::sort(ends);
  Turning sum;
  for (std::size_t k = 1; k < ends.size(); ++k)
    for (int i = 0; i < steps; ++i) {
      const auto at = [&](int step) { return ends[k - 1] + (ends[k] - ends[k - 1]) * step / steps; };
      const Vec2 before = derivative(curve, at(i)), after = derivative(curve, at(i + 1));
      const double turn = std::atan2(cross(before, after), before.dot(after));
      (turn > 0.0 ? sum.left : sum.right) += std::abs(turn);
    }
  return sum;
}

double run_back(const Bezier& curve, double from, double to) {
  const Vec2 start = evaluate(curve, from), along = (evaluate(curve, to) - start).normalized();
  const double e0 = along.dot(curve[1] - curve[0]), e1 = along.dot(curve[2] - curve[1]),
               e2 = along.dot(curve[3] - curve[2]);
  std::vector<double> ends = inner_roots(e0 - 2.0 * e1 + e2, 2.0 * (e1 - e0), e0);
  std::erase_if(ends, [&](double t) { return !(t > from && t < to); });
  ends.push_back(from);
  ends.push_back(to);
  std::ranges::sort(ends);
  double sum = 0.0;
  for (std::size_t k = 1; k < ends.size(); ++k)
    sum += std::max(0.0, along.dot(evaluate(curve, ends[k - 1]) - evaluate(curve, ends[k])));
  return sum;
}

double nearest_parameter(const Bezier& curve, const Vec2& target) {
  const auto distance = [&](double t) { return (evaluate(curve, t) - target).squaredNorm(); };
  const auto slope = [&](double t) { return (evaluate(curve, t) - target).dot(derivative(curve, t)); };
  double nearest = distance(1.0) < distance(0.0) ? 1.0 : 0.0;
  // The slope is of degree 5: of its few roots, those where it rises are the minima.
  constexpr int intervals = 64;
  for (int i = 0; i < intervals; ++i) {
    double low = static_cast<double>(i) / intervals, high = static_cast<double>(i + 1) / intervals;
    if (!(slope(low) < 0.0) || slope(high) < 0.0) continue;
    halve_between(low, high, 60, [&](double t) { return slope(t) < 0.0; });
    if (distance(high) < distance(nearest)) nearest = high;
  }
  return nearest;
}

}  // namespace selvage::nurbs
