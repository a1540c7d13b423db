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

namespace {

nurbs::Curve outline_curve(const yarn::Section& section) {
  constexpr int pieces = 8;  // in a quarter
  return yarn::as_curve(yarn::make_outline(section, yarn::nominal_size(section), pieces, false));
}

std::vector<Vec2> polygon_of(const nurbs::Curve& curve, int looks) {
  std::vector<Vec2> polygon;
  for (const double t : nurbs::divided(curve.knots, curve.degree, looks))
    polygon.push_back(nurbs::evaluate(curve, t).head<2>());
  polygon.pop_back();  // it is the first again
  return polygon;
}

double reach_of(const std::vector<Vec2>& outline) {
  double reach = 0.0;
  for (const Vec2& q : outline) reach = std::max(reach, q.norm());
  return reach;
}

}  // namespace

std::vector<Vec2> outline_polygon(const yarn::Section& section, int looks) {
  return polygon_of(outline_curve(section), looks);
}

std::vector<Vec2> dense_outline_polygon(const yarn::Section& section, int count) {
  if (std::holds_alternative<yarn::Polygon>(section)) return outline_polygon(section);
  const nurbs::Curve curve = outline_curve(section);
  const auto spans = static_cast<int>(nurbs::breakpoints(curve.knots, curve.degree).size()) - 1;
  return polygon_of(curve, (count + spans - 1) / spans);
}

double outline_reach(const yarn::Section& section) {
  constexpr int points = 256;
  return reach_of(dense_outline_polygon(section, points));
}

namespace {

// How far the fine outline reaches beyond the other one.
double coarseness(const SweptYarn& yarn) {
  double most = 0.0;
  for (const Vec2& q : yarn.fine) most = std::max(most, signed_distance(yarn.outline, q));
  return most;
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
      if (std::abs(move) < 1e-6 * reach_) break;
    }
    return station;
  }
  // Where the gap is at least `enough`, perhaps a lower bound of it that is, too: from the circle about the
  // outline, of radius `reach`.
  double gap_of(const SweptStation& on, const Vec2& q, const std::vector<Vec2>& outline, double reach,
                double enough = std::numeric_limits<double>::infinity()) {
    const Vec3 p = on.position + q.x() * on.across + q.y() * on.up;
    const SweptStation foot = foot_of(p);
    const Vec3 d = p - foot.position;
    const Vec2 seen(d.dot(foot.across), d.dot(foot.up));
    const double bound = seen.norm() - reach;
    return bound >= enough ? bound : signed_distance(outline, seen);
  }

 private:
  const SweptYarn& b_;
  double near_, reach_, t_;
};

// Where a point of the outline is nearer than at the stations beside.
struct Low {
  double gap, at;
  std::size_t point;
};

// The least value of f between two places, where it falls and then rises (golden section).
template <class Function>
double least_between(double low, double high, const Function& f) {
  constexpr double golden = 0.6180339887498949;
  constexpr int steps = 16;
  double x = high - golden * (high - low), y = low + golden * (high - low);
  double at_x = f(x), at_y = f(y);
  for (int i = 0; i < steps; ++i) {
    if (at_x < at_y) {
      high = y;
      y = x;
      at_y = at_x;
      x = high - golden * (high - low);
      at_x = f(x);
    } else {
      low = x;
      x = y;
      at_x = at_y;
      y = low + golden * (high - low);
      at_y = f(y);
    }
  }
  return std::min(at_x, at_y);
}

}  // namespace

double refined_gap(const SweptYarn& a, double from, double to, int stations, const SweptYarn& b,
                   double near_b, double reach_b) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double step = (to - from) / stations, reach = reach_of(b.outline),
               reaches = reach_of(a.outline) + reach;
  const auto place = [&](int i) { return from + step * i; };
  const std::size_t count = a.outline.size();
  GapSearch search(b, near_b, reach_b);
  double travel = 0.0;                              // of a point between two stations, about
  std::vector<std::pair<double, int>> by_distance;  // of the paths
  for (int i = 0; i <= stations; ++i) {
    const SweptStation on = a.at(place(i));
    travel = std::max(travel, 1.25 * step * on.derivative.norm());
    search.restart();
    by_distance.emplace_back((search.foot_of(on.position).position - on.position).norm(), i);
  }
  std::sort(by_distance.begin(), by_distance.end());
  double gap = infinity;
  std::vector<std::vector<double>> gaps(static_cast<std::size_t>(stations) + 3,
                                        std::vector<double>(count, infinity));  // one more at either end
  for (const auto& [distance, i] : by_distance) {
    if (distance - reaches > gap + travel) break;
    const SweptStation on = a.at(place(i));
    search.restart();
    search.foot_of(on.position);
    for (std::size_t k = 0; k < count; ++k) {
      const double here = search.gap_of(on, a.outline[k], b.outline, reach, gap + travel);
      gaps[static_cast<std::size_t>(i) + 1][k] = here;
      gap = std::min(gap, here);
    }
  }
  // What may be nearer between a low station and one that is no lower: a gap changes by no more than the way.
  const double fall = 0.5 * travel;
  std::vector<Low> lows;
  for (int i = 0; i <= stations; ++i) {
    const auto row = static_cast<std::size_t>(i) + 1;
    for (std::size_t k = 0; k < count; ++k)
      if (gaps[row][k] < gap + fall && gaps[row][k] <= std::min(gaps[row - 1][k], gaps[row + 1][k]))
        lows.push_back({gaps[row][k], place(i), k});
  }
  std::stable_sort(lows.begin(), lows.end(), [](const Low& x, const Low& y) { return x.gap < y.gap; });
  for (const Low& low : lows) {
    if (low.gap >= gap + fall) break;
    search.restart();
    search.foot_of(a.at(low.at).position);
    gap = std::min(gap,
                   least_between(std::max(low.at - step, from), std::min(low.at + step, to), [&](double t) {
                     return search.gap_of(a.at(t), a.outline[low.point], b.outline, reach);
                   }));
  }
  return gap;
}

double least_gap(const SweptYarn& a, double from, double to, int stations, const SweptYarn& b, double near_b,
                 double reach_b) {
  struct Near {
    int station;
    std::size_t point;
    double gap;
  };
  const bool refines = !a.fine.empty() && !b.fine.empty();
  const double slack = refines ? coarseness(a) + coarseness(b) : 0.0;
  const double reach = reach_of(b.outline), reaches = reach_of(a.outline) + reach;
  std::vector<Near> near;
  GapSearch search(b, near_b, reach_b);
  double gap = std::numeric_limits<double>::infinity();
  const auto station_at = [&](int i) { return a.at(from + (to - from) * i / stations); };
  for (int i = 0; i <= stations; ++i) {
    const SweptStation on = station_at(i);
    search.restart();
    if ((search.foot_of(on.position).position - on.position).norm() - reaches > gap + slack) continue;
    for (std::size_t k = 0; k < a.outline.size(); ++k) {
      const double here = search.gap_of(on, a.outline[k], b.outline, reach, gap + slack);
      gap = std::min(gap, here);
      if (refines && here < gap + slack) near.push_back({i, k, here});
    }
  }
  if (!refines) return gap;
  const std::size_t finer = a.fine.size() / a.outline.size(), count = a.fine.size();
  const double coarse_gap = gap, fine_reach = reach_of(b.fine);
  for (const Near& place : near) {
    if (place.gap >= coarse_gap + slack) continue;
    const SweptStation on = station_at(place.station);
    search.restart();
    for (std::size_t i = count + 1 - finer; i < count + finer; ++i)
      gap = std::min(gap,
                     search.gap_of(on, a.fine[(place.point * finer + i) % count], b.fine, fine_reach, gap));
  }
  return gap;
}

}  // namespace selvage::fabric
