#include "fabric/clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "yarn/outline.h"

namespace selvage::fabric {

double signed_distance(const std::vector<Vec2>& polygon, const Vec2& p) {
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = false;
  Vec2 a = polygon.back();
  for (const Vec2& b : polygon) {
    const Vec2 edge = b - a, to = p - a;
    const double along = std::clamp(to.dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (to - along * edge).squaredNorm());
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + edge.x() * (p.y() - a.y()) / edge.y())
      inside = !inside;
    a = b;
  }
  return inside ? -std::sqrt(nearest) : std::sqrt(nearest);
}

std::vector<Vec2> outline_polygon(const yarn::Section& section) {
  constexpr int pieces = 8, looks = 2;  // in a quarter, in a piece of it
  const yarn::Outline outline = yarn::make_outline(section, yarn::nominal_size(section), pieces, false);
  nurbs::Curve curve;
  curve.degree = outline.degree;
  curve.knots = outline.knots;
  for (const Vec2& p : outline.points) curve.points.emplace_back(p.x(), p.y(), 0.0);
  std::vector<Vec2> polygon;
  const std::vector<double> breaks = nurbs::breakpoints(curve.knots, curve.degree);
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
    for (int i = 0; i < looks; ++i)
      polygon.push_back(
          nurbs::evaluate(curve, breaks[k] + (breaks[k + 1] - breaks[k]) * i / looks).head<2>());
  return polygon;
}

double least_gap(const SweptYarn& a, double from, double to, int stations, const SweptYarn& b, double near_b,
                 double reach_b) {
  double gap = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= stations; ++i) {
    const SweptStation sa = a.at(from + (to - from) * i / stations);
    double t = near_b;  // neighbours on the outline have their feet near each other
    for (const Vec2& q : a.outline) {
      const Vec3 p = sa.position + q.x() * sa.across + q.y() * sa.up;
      SweptStation sb = b.at(t);
      for (int step = 0; step < 8; ++step) {
        const double move = (p - sb.position).dot(sb.derivative) / sb.derivative.squaredNorm();
        t = std::clamp(t + move, near_b - reach_b, near_b + reach_b);
        sb = b.at(t);
        if (std::abs(move) < 1e-6) break;
      }
      const Vec3 d = p - sb.position;
      gap = std::min(gap, signed_distance(b.outline, Vec2(d.dot(sb.across), d.dot(sb.up))));
    }
  }
  return gap;
}

}  // namespace selvage::fabric
