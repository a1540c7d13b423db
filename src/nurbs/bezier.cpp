#include "nurbs/bezier.h"

#include <algorithm>
#include <cmath>

#include "nurbs/basis.h"

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
    sum += 0.5 * rule.weights[g] * (p.x() * d.y() - p.y() * d.x());
  }
  return 0.5 * sum;
}

double nearest_parameter(const Bezier& curve, const Vec2& target) {
  constexpr int samples = 64;
  int best = 0;
  double least = (curve[0] - target).squaredNorm();
  for (int i = 1; i <= samples; ++i) {
    const double distance = (evaluate(curve, static_cast<double>(i) / samples) - target).squaredNorm();
    if (distance < least) {
      least = distance;
      best = i;
    }
  }
  // Between the neighbouring samples the distance falls, then rises: its slope is bisected.
  double low = std::max(best - 1, 0) / static_cast<double>(samples);
  double high = std::min(best + 1, samples) / static_cast<double>(samples);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    const double slope = (evaluate(curve, middle) - target).dot(derivative(curve, middle));
    (slope < 0.0 ? low : high) = middle;
  }
  const double found = 0.5 * (low + high);
  double nearest = found;
  for (double t : {static_cast<double>(best) / samples, 0.0, 1.0})
    if ((evaluate(curve, t) - target).squaredNorm() < (evaluate(curve, nearest) - target).squaredNorm())
      nearest = t;
  return nearest;
}

}  // namespace selvage::nurbs
