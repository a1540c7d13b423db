#include "cad/region.h"

#include <algorithm>
#include <cmath>
#include <optional>

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
      points.push_back(
          nurbs::evaluate(flat, std::lerp(spans[i], spans[i + 1], static_cast<double>(k) / each)));
  points.push_back(nurbs::evaluate(flat, spans.back()));
  return points;
}

// The feet of an edge's points; in the turn round the surface in which `before` is, where that is given.
std::vector<Vec3> feet_of(const nurbs::Curve& curve, const SurfaceSet& surface, const Vec3* before,
                          const std::array<double, 2>& periods) {
  std::vector<Vec3> points;
  for (const Vec3& p : SampledCurve(curve).points) {
    const SurfaceSet::Foot foot = surface.near(p);
    Vec3 place(foot.u, foot.v, 0);
    const Vec3* const last = points.empty() ? before : &points.back();
    for (Eigen::Index d = 0; last != nullptr && d < 2; ++d)
      if (const double period = periods[static_cast<std::size_t>(d)]; period > 0)
        place[d] -= period * std::round((place[d] - (*last)[d]) / period);
    points.push_back(place);
  }
  return points;
}

}  // namespace

Region::Region(const Face& face) {
  const Range whole = range_ = domain(face.surface);
  if (face.loops.empty()) return;
  const std::array<double, 2> widths = {whole.u1 - whole.u0, whole.v1 - whole.v0};
  for (std::size_t d = 0; d < 2; ++d) {
    if (is_closed(face.surface, d == 0)) periods_[d] = widths[d];
    near_[d] = 1e-9 * widths[d];
  }
  std::optional<SurfaceSet> surface;
  std::array<int, 2> rounds = {0, 0};  // loops that go round the surface
  for (const Loop& loop : face.loops) {
    std::vector<Vec3> points;
    for (const Edge& edge : loop.edges) {
      if (edge.flat.points.empty() && edge.curve.points.empty()) continue;  // a pole
      if (edge.flat.points.empty() && !surface) surface.emplace(std::vector<const Surface*>{&face.surface});
      const std::vector<Vec3> piece =
          edge.flat.points.empty()
              ? feet_of(edge.curve, *surface, points.empty() ? nullptr : &points.back(), periods_)
              : polygon_of(edge.flat);
      points.insert(points.end(), piece.begin(), piece.end());
    }
    if (points.size() < 2) return;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vec3 &a = points[k], &b = points[(k + 1) % points.size()];
      const Vec3 step = b - a;
      bool jumps = false;
      if (k + 1 == points.size())
        for (std::size_t d = 0; d < 2; ++d)
          if (periods_[d] > 0 &&
              std::abs(std::abs(step[static_cast<Eigen::Index>(d)]) - periods_[d]) < 1e-3 * periods_[d]) {
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
  if (!is_known_) return;
  Box3 box;
  for (const Segment& s : segments_)
    for (const std::array<double, 2>& end : {s.from, s.to}) box.extend(Vec3(end[0], end[1], 0));
  const auto narrow = [](double& low, double& high, double least, double most, double period) {
    // What is given in another turn round the surface has no range here.
    if (period > 0 && (least < low - 1e-9 * period || most > high + 1e-9 * period)) return;
    const double first = std::max(low, least), last = std::min(high, most);
    if (first < last) {
      low = first;
      high = last;
    }
  };
  if (rounds[0] == 0) narrow(range_.u0, range_.u1, box.min().x(), box.max().x(), periods_[0]);
  if (rounds[1] == 0) narrow(range_.v0, range_.v1, box.min().y(), box.max().y(), periods_[1]);
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
