#include "surface_mesh/crest_tips.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace selvage::fem {

namespace {

constexpr double slanted = 0.8;      // sine of the angle between a crest and a face, below which it counts
constexpr double first_share = 0.4;  // of the yarn's largest edge: the needle's first
constexpr double seen_at = 0.27;     // tangent of the angle that a prism of a needle may have, 15 degrees
constexpr double steps_per_edge = 3;

// Where the arc crosses the crests of its yarn.
std::vector<CrestCrossing> crossings_of(const cell::ArcCurve& curve, const std::vector<Vec2>& q,
                                        const std::vector<double>& crests, double period) {
  const std::vector<double>& lengths = curve.lengths();
  std::vector<CrestCrossing> result;
  for (std::size_t k = 0; k + 1 < q.size(); ++k)
    for (const double crest : crests) {
      const double low = std::min(q[k].x(), q[k + 1].x()), high = std::max(q[k].x(), q[k + 1].x());
      const auto first_turn = static_cast<long>(std::ceil((low - crest) / period)),
                 last_turn = static_cast<long>(std::floor((high - crest) / period));
      for (long turn = first_turn; turn <= last_turn; ++turn) {
        const double u = crest + period * static_cast<double>(turn);
        // Each kept point belongs to the step behind it, the last to the one before it.
        if (u == q[k + 1].x() && k + 2 < q.size()) continue;
        double from = lengths[k], to = lengths[k + 1];
        const bool rising = q[k + 1].x() > q[k].x();
        if (u == q[k].x()) to = from;
        if (u == q[k + 1].x()) from = to;
        for (int step = 0; step < 60 && to - from > 1e-15 * lengths.back(); ++step) {
          const double middle = (from + to) / 2;
          ((curve.at(middle).x() < u) == rising ? from : to) = middle;
        }
        result.push_back({(from + to) / 2, u});
      }
    }
  std::sort(result.begin(), result.end(),
            [](const CrestCrossing& a, const CrestCrossing& b) { return a.along < b.along; });
  return result;
}

// A crest as the line that it is near a face, and how thick the yarn is beside it.
struct Crest {
  Vec3 at, direction;
  double thickness = 0;  // per distance from it

  [[nodiscard]] double distance(const Vec3& point) const {
    const Vec3 way = point - at;
    return (way - way.dot(direction) * direction).norm();
  }
};

Crest crest_at(const yarn::Body& body, const Vec2& parameters) {
  const double step = 1e-4 * cell::periods(body).x();
  const Vec3 direction = cell::jet(body, parameters).dv.normalized();
  const auto across = [&](double u) {
    const Vec3 way = cell::jet(body, Vec2(u, parameters.y())).du;
    return Vec3(way - way.dot(direction) * direction);
  };
  const Vec3 before = across(parameters.x() - step), after = across(parameters.x() + step);
  const double inner = std::numbers::pi - std::atan2(before.cross(after).norm(), before.dot(after));
  return {cell::position(body, parameters), direction, 2 * std::tan(inner / 2)};
}

class TipFinder {
 public:
  TipFinder(const CellShape& shape, const SizeRules& rules) : shape_(shape), rules_(rules) {}

  CrestTips run() {
    for (const cell::Piece& piece : shape_.cut.pieces) {
      const yarn::Body& body = shape_.bodies[piece.body];
      const std::vector<double> crests = crests_of(body.surface);
      for (const cell::Border& border : piece.borders)
        for (const cell::Arc& arc : border.arcs) {
          const cell::ArcCurve curve(body, shape_.cell, arc);
          const bool is_closed = shape_.division.edges[tips_.of_arcs.size()].is_border();
          tips_.of_arcs.push_back(crossings_of(curve, arc.parameters, crests, cell::periods(body).x()));
          if (arc.face >= cell::face_count) continue;
          for (CrestCrossing& crossing : tips_.of_arcs.back())
            bound(piece.body, arc.face, curve, is_closed, crossing);
        }
    }
    return std::move(tips_);
  }

 private:
  void bound(std::size_t number, int face, const cell::ArcCurve& curve, bool is_closed,
             CrestCrossing& crossing) {
    Vec2 parameters = curve.at(crossing.along);
    parameters.x() = crossing.crest;
    const Crest crest = crest_at(shape_.bodies[number], parameters);
    const double sine = std::abs(crest.direction.dot(shape_.cell.axes.normal(cell::axis_of(face))));
    const double largest = rules_.yarns[number].largest, share = crest.thickness / seen_at;
    if (sine > slanted || share * sine > 1) return;
    const double length = curve.length();
    crossing.first = std::min(first_share * largest, length / 8);
    for (const double way : {-1.0, 1.0}) {
      double from = crossing.first;
      while (from < length / 2) {
        double along = crossing.along + way * from;
        if (is_closed) along -= length * std::floor(along / length);
        if (along < 0 || along > length) break;
        const Vec3 place = curve.position(curve.at(along));
        const double size = std::max(share * crest.distance(place), rules_.smallest);
        if (size >= largest) break;
        tips_.bounds.push_back({place, size});
        from += size / steps_per_edge;
      }
    }
  }

  const CellShape& shape_;
  const SizeRules& rules_;
  CrestTips tips_;
};

}  // namespace

CrestTips find_crest_tips(const CellShape& shape, const SizeRules& rules) {
  return TipFinder(shape, rules).run();
}

}  // namespace selvage::fem
