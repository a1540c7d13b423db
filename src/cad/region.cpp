#include "cad/region.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "cad/feet.h"
#include "cad/sampled_curve.h"
#include "cad/seam.h"
#include "nurbs/basis.h"

namespace selvage::cad {

namespace {

constexpr int points_a_span = 16;

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

// In the turn round the surface in which `other` is.
void bring_near(std::vector<Vec3>& points, const Vec2& other, const std::array<double, 2>& periods) {
  const Vec2 turns = turns_towards(points.front().head<2>(), other, periods);
  for (Vec3& p : points) p.head<2>() += turns;
}

std::vector<Vec3> feet_of(Feet& feet, const nurbs::Curve& curve) {
  CurveFeet along(feet, curve);
  std::vector<Vec3> points;
  for (const double t : SampledCurve(curve).parameters) {
    const Vec2 foot = along.at(t);
    points.emplace_back(foot.x(), foot.y(), 0);
  }
  return points;
}

}  // namespace

Region::Region(const Face& face) {
  const Range whole = range_ = domain(face.surface);
  if (face.loops.empty()) return;
  periods_ = periods_of(face.surface);
  near_ = {1e-9 * (whole.u1 - whole.u0), 1e-9 * (whole.v1 - whole.v0)};
  const Vec2 middle(0.5 * (whole.u0 + whole.u1), 0.5 * (whole.v0 + whole.v1));
  std::optional<Feet> feet;
  std::array<int, 2> rounds = {0, 0};  // loops that go round the surface
  std::array<int, 2> turns = {0, 0};   // of the last of them
  for (Loop loop : face.loops) {
    begin_at_pole(loop, face.surface);
    std::vector<Vec3> points;
    for (const Edge& edge : loop.edges) {
      if (edge.flat.points.empty() && edge.curve.points.empty()) continue;  // a pole
      const Vec3* const last = points.empty() ? nullptr : &points.back();
      std::vector<Vec3> piece;
      if (flat_holds(face.surface, edge)) {
        piece = polygon_of(edge.flat);
      } else {
        if (!feet) feet.emplace(face.surface);
        piece = feet_of(*feet, edge.curve);
      }
      if (last != nullptr) bring_near(piece, last->head<2>(), periods_);
      points.insert(points.end(), piece.begin(), piece.end());
    }
    if (points.size() < 2) return;
    bring_near(points, middle, periods_);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vec3 &a = points[k], &b = points[(k + 1) % points.size()];
      const Vec3 step = b - a;
      bool jumps = false;
      if (k + 1 == points.size())
        for (std::size_t d = 0; d < 2; ++d)
          if (periods_[d] > 0 &&
              std::abs(std::abs(step[static_cast<Eigen::Index>(d)]) - periods_[d]) < 1e-3 * periods_[d]) {
            ++rounds[d];
            turns[d] = step[static_cast<Eigen::Index>(d)] < 0 ? 1 : -1;
            jumps = true;
          }
      if (!jumps) segments_.push_back({{a.x(), a.y()}, {b.x(), b.y()}});
    }
  }
  if (rounds[0] > 0 && rounds[1] > 0) return;
  if (segments_.empty()) return;
  along_v_ = rounds[0] > 0;
  Box3 box;
  if (rounds[0] + rounds[1] == 1) {
    // A cap round a pole.
    const std::size_t across = along_v_ ? 1 : 0;
    const auto is_high = is_high_side(face.surface, across, turns[1 - across]);
    if (!is_high || periods_[across] > 0) return;
    is_all_but_ = *is_high;
    const std::array<double, 2> ends =
        across == 0 ? std::array{whole.u0, whole.u1} : std::array{whole.v0, whole.v1};
    Vec3 pole(segments_.front().from[0], segments_.front().from[1], 0);
    pole[static_cast<Eigen::Index>(across)] = ends[*is_high ? 1 : 0];
    box.extend(pole);
  } else if (rounds[0] % 2 != 0 || rounds[1] % 2 != 0) {
    return;
  }
  is_known_ = true;
  for (const Segment& s : segments_)
    for (const std::array<double, 2>& end : {s.from, s.to}) box.extend(Vec3(end[0], end[1], 0));
  for (std::size_t d = 0; d < 2; ++d) {
    const auto k = static_cast<Eigen::Index>(d);
    if (periods_[d] > 0 && !(box.max()[k] - box.min()[k] < most_turns * periods_[d])) is_known_ = false;
  }
  if (!is_known_) return;
  extent_ = {{{box.min().x(), box.max().x()}, {box.min().y(), box.max().y()}}};
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

// All the turns round the surface together: loops are wherever their first points lie, a hole perhaps a turn
// away from the loop that it is in.
bool Region::contains(double u, double v) const {
  if (!is_known_) return true;
  bool is_inside = is_all_but_;
  for (const double turn_u : turns(0, u, u))
    for (const double turn_v : turns(1, v, v))
      if (contains_as_it_is(u + turn_u, v + turn_v)) is_inside = !is_inside;
  return is_inside;
}

std::vector<double> Region::turns(std::size_t d, double first, double last) const {
  const double period = periods_[d];
  if (period == 0) return {0};
  std::vector<double> shifts;
  for (double k = std::ceil((extent_[d][0] - last) / period); k * period <= extent_[d][1] - first; ++k)
    shifts.push_back(k * period);
  return shifts;
}

bool Region::may_meet(const Range& range) const {
  if (!is_known_) return true;
  if (contains(0.5 * (range.u0 + range.u1), 0.5 * (range.v0 + range.v1))) return true;
  const double wide = 0.05 * (range.u1 - range.u0) + near_[0], high = 0.05 * (range.v1 - range.v0) + near_[1];
  const auto meets = [&](const Segment& s, double turn_u, double turn_v) {
    return std::max(s.from[0], s.to[0]) >= range.u0 + turn_u - wide &&
           std::min(s.from[0], s.to[0]) <= range.u1 + turn_u + wide &&
           std::max(s.from[1], s.to[1]) >= range.v0 + turn_v - high &&
           std::min(s.from[1], s.to[1]) <= range.v1 + turn_v + high;
  };
  const std::vector<double> turns_u = turns(0, range.u0 - wide, range.u1 + wide),
                            turns_v = turns(1, range.v0 - high, range.v1 + high);
  for (const Segment& s : segments_)
    for (const double turn_u : turns_u)
      for (const double turn_v : turns_v)
        if (meets(s, turn_u, turn_v)) return true;
  return false;
}

}  // namespace selvage::cad
