#include "cad/region.h"

#include <algorithm>
#include <cmath>

#include "cad/edges.h"
#include "cad/sampled_curve.h"
#include "nurbs/basis.h"

namespace selvage::cad {

namespace {

using nurbs::Surface;

constexpr int points_a_span = 16;

bool is_closed(const Surface& s, bool in_u) {
  const double size = box_of(s.points).diagonal().norm();
  for (const double share : {0.2, 0.5, 0.7}) {
    const Vec3 a = in_u ? at_shares(s, 0, share) : at_shares(s, share, 0);
    const Vec3 b = in_u ? at_shares(s, 1, share) : at_shares(s, share, 1);
    if ((a - b).norm() > 1e-9 * size) return false;
  }
  return true;
}

std::vector<Vec3> polygon_of(const nurbs::Curve& flat) {
  const std::vector<double> spans = nurbs::breakpoints(flat.knots, flat.degree);
  const int each = flat.degree == 1 ? 1 : points_a_span;
  std::vector<Vec3> points;
  for (std::size_t i = 0; i + 1 < spans.size(); ++i)
    for (int k = 0; k < each; ++k)
      points.push_back(nurbs::evaluate(flat, std::lerp(spans[i], spans[i + 1], static_cast<double>(k) / each)));
  points.push_back(nurbs::evaluate(flat, spans.back()));
  return points;
}

}  // namespace

Region::Region(const Face& face) {
  if (face.loops.empty()) return;
  const Range whole = domain(face.surface);
  const std::array<double, 2> widths = {whole.u1 - whole.u0, whole.v1 - whole.v0};
  for (std::size_t d = 0; d < 2; ++d) {
    if (is_closed(face.surface, d == 0)) periods_[d] = widths[d];
    near_[d] = 1e-9 * widths[d];
  }
  std::array<int, 2> rounds = {0, 0};  // loops that go round the surface
  for (const Loop& loop : face.loops) {
    std::vector<Vec3> points;
    for (const Edge& edge : loop.edges) {
      if (edge.flat.points.empty()) return;
      const std::vector<Vec3> piece = polygon_of(edge.flat);
      points.insert(points.end(), piece.begin(), piece.end());
    }
    if (points.size() < 2) return;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vec3 &a = points[k], &b = points[(k + 1) % points.size()];
      const Vec3 step = b - a;
      bool jumps = false;
      if (k + 1 == points.size())
        for (std::size_t d = 0; d < 2; ++d)
          if (periods_[d] > 0 && std::abs(std::abs(step[static_cast<Eigen::Index>(d)]) - periods_[d]) < 1e-3 * periods_[d]) {
            ++rounds[d];
            jumps = true;
          }
      if (!jumps) segments_.push_back({{a.x(), a.y()}, {b.x(), b.y()}});
    }
  }
  if (rounds[0] > 0 && rounds[1] > 0) return;
  if (rounds[0] % 2 != 0 || rounds[1] % 2 != 0) return;  // a cap round a pole: of the two sides none is told
  along_v_ = rounds[0] > 0;
  is_known_ = !segments_.empty();
}

bool Region::contains_as_it_is(double u, double v) const {
  const std::size_t across = along_v_ ? 0 : 1, along = 1 - across;
  const std::array<double, 2> p = {u, v};
  bool is_inside = false;
  for (const Segment& s : segments_) {
    if ((s.from[across] > p[across]) == (s.to[across] > p[across])) continue;
    const double share = (p[across] - s.from[across]) / (s.to[across] - s.from[across]);
    if (std::lerp(s.from[along], s.to[along], share) > p[along]) is_inside = !is_inside;
  }
  return is_inside;
}

bool Region::contains(double u, double v) const {
  if (!is_known_) return true;
  for (const double turn_u : {0.0, -periods_[0], periods_[0]})
    for (const double turn_v : {0.0, -periods_[1], periods_[1]})
      if (contains_as_it_is(u + turn_u, v + turn_v)) return true;
  return false;
}

bool Region::may_meet(const Range& range) const {
  if (!is_known_) return true;
  if (contains(0.5 * (range.u0 + range.u1), 0.5 * (range.v0 + range.v1))) return true;
  const double wide = 0.05 * (range.u1 - range.u0) + near_[0], high = 0.05 * (range.v1 - range.v0) + near_[1];
  const auto meets = [&](const Segment& s, double turn_u, double turn_v) {
    return std::max(s.from[0], s.to[0]) + turn_u >= range.u0 - wide &&
           std::min(s.from[0], s.to[0]) + turn_u <= range.u1 + wide &&
           std::max(s.from[1], s.to[1]) + turn_v >= range.v0 - high &&
           std::min(s.from[1], s.to[1]) + turn_v <= range.v1 + high;
  };
  for (const Segment& s : segments_)
    for (const double turn_u : {0.0, -periods_[0], periods_[0]})
      for (const double turn_v : {0.0, -periods_[1], periods_[1]})
        if (meets(s, turn_u, turn_v)) return true;
  return false;
}

}  // namespace selvage::cad
