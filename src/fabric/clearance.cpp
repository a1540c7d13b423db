#include "fabric/clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/plane.h"
#include "nurbs/divided.h"
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
    if (ray_meets(p, a, b)) inside = !inside;
    a = b;
  }
  return inside ? -std::sqrt(nearest) : std::sqrt(nearest);
}

std::vector<Vec2> outline_polygon(const yarn::Section& section, int looks) {
  constexpr int pieces = 8;  // in a quarter
  const nurbs::Curve curve =
      yarn::as_curve(yarn::make_outline(section, yarn::nominal_size(section), pieces, false));
  std::vector<Vec2> polygon;
  for (const double t : nurbs::divided(curve.knots, curve.degree, looks))
    polygon.push_back(nurbs::evaluate(curve, t).head<2>());
  polygon.pop_back();  // it is the first again
  return polygon;
}

namespace {

// How far the fine outline reaches beyond the other one.
double coarseness(const SweptYarn& yarn) {
  double most = 0.0;
  for (const Vec2& q : yarn.fine) most = std::max(most, signed_distance(yarn.outline, q));
  return most;
}

double reach_of(const std::vector<Vec2>& outline) {
  double reach = 0.0;
  for (const Vec2& q : outline) reach = std::max(reach, q.norm());
  return reach;
}

// Points of a yarn's surface against the section of another in whose plane they lie.
class GapSearch {
 public:
  GapSearch(const SweptYarn& b, double near_b, double reach_b)
      : b_(b), near_(near_b), reach_(reach_b), t_(near_b) {}

  // Begins anew at the middle; after this, neighbours have their feet near each other.
  void restart() { t_ = near_; }
  SweptStation foot_of(const Vec3& p) {
    SweptStation station = b_.at(t_);
    for (int step = 0; step < 8; ++step) {
      const double move = (p - station.position).dot(station.derivative) / station.derivative.squaredNorm();
      t_ = std::clamp(t_ + move, near_ - reach_, near_ + reach_);
      station = b_.at(t_);
      if (std::abs(move) < 1e-6) break;
    }
    return station;
  }
  double gap_of(const SweptStation& on, const Vec2& q, const std::vector<Vec2>& outline) {
    const Vec3 p = on.position + q.x() * on.across + q.y() * on.up;
    const SweptStation foot = foot_of(p);
    const Vec3 d = p - foot.position;
    return signed_distance(outline, Vec2(d.dot(foot.across), d.dot(foot.up)));
  }

 private:
  const SweptYarn& b_;
  double near_, reach_, t_;
};

}  // namespace

double least_gap(const SweptYarn& a, double from, double to, int stations, const SweptYarn& b, double near_b,
                 double reach_b) {
  struct Near {
    int station;
    std::size_t point;
    double gap;
  };
  const bool refines = !a.fine.empty() && !b.fine.empty();
  const double slack = refines ? coarseness(a) + coarseness(b) : 0.0;
  const double reaches = reach_of(a.outline) + reach_of(b.outline);
  std::vector<Near> near;
  GapSearch search(b, near_b, reach_b);
  double gap = std::numeric_limits<double>::infinity();
  const auto station_at = [&](int i) { return a.at(from + (to - from) * i / stations); };
  for (int i = 0; i <= stations; ++i) {
    const SweptStation on = station_at(i);
    search.restart();
    if ((search.foot_of(on.position).position - on.position).norm() - reaches > gap + slack) continue;
    for (std::size_t k = 0; k < a.outline.size(); ++k) {
      const double here = search.gap_of(on, a.outline[k], b.outline);
      gap = std::min(gap, here);
      if (refines && here < gap + slack) near.push_back({i, k, here});
    }
  }
  if (!refines) return gap;
  const std::size_t finer = a.fine.size() / a.outline.size(), count = a.fine.size();
  const double coarse_gap = gap;
  for (const Near& place : near) {
    if (place.gap >= coarse_gap + slack) continue;
    const SweptStation on = station_at(place.station);
    search.restart();
    for (std::size_t i = count + 1 - finer; i < count + finer; ++i)
      gap = std::min(gap, search.gap_of(on, a.fine[(place.point * finer + i) % count], b.fine));
  }
  return gap;
}

}  // namespace selvage::fabric
