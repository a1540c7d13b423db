#include "cad/seam.h"

#include <algorithm>
#include <cmath>

#include "cad/edges.h"
#include "cad/sampled_curve.h"
#include "nurbs/chain.h"
#include "nurbs/restrict.h"

namespace selvage::cad {

namespace {

using nurbs::Surface;

// As a share of the range. No span may be as short, and a boundary that leaves the range by less stays where
// it is.
constexpr double no_width = 1e-6;

// One behind the other along u: the last column of `a` is the first one of `b`.
Surface joined(Surface a, const Surface& b) {
  const double step = a.last_u() - b.first_u();
  a.knots_u.pop_back();
  for (auto knot = b.knots_u.begin() + b.degree_u + 1; knot != b.knots_u.end(); ++knot)
    a.knots_u.push_back(*knot + step);
  Surface whole = a;
  whole.count_u += b.count_u - 1;
  whole.points.clear();
  whole.weights.clear();
  const double factor = a.is_rational() ? a.weight(a.count_u - 1, 0) / b.weight(0, 0) : 1;
  for (int j = 0; j < a.count_v; ++j) {
    for (int i = 0; i < whole.count_u; ++i) {
      const int k = i - a.count_u + 1;  // in b
      whole.points.push_back(k <= 0 ? a.point(i, j) : b.point(k, j));
      if (a.is_rational()) whole.weights.push_back(k <= 0 ? a.weight(i, j) : factor * b.weight(k, j));
    }
  }
  return whole;
}

// The same surface from the parameter `start` on, over as wide a range: closed in u.
Surface opened_at(const Surface& s, double start) {
  const double first = s.first_u(), last = s.last_u(), period = last - first;
  const double turns = std::floor((start - first) / period + no_width);
  double at = start - turns * period;
  for (const double knot : s.knots_u)
    if (std::abs(at - knot) <= no_width * period) at = knot;
  Surface opened = at <= first + no_width * period
                       ? s
                       : joined(nurbs::restricted(s, at, last, s.first_v(), s.last_v()),
                                nurbs::restricted(s, first, at, s.first_v(), s.last_v()));
  for (double& knot : opened.knots_u) knot += turns * period;
  return opened;
}

}  // namespace

bool closes(const Surface& surface, bool in_u) {
  const double size = box_of(surface.points).diagonal().norm();
  for (const double share : {0.2, 0.5, 0.7}) {
    const Vec3 a = in_u ? at_shares(surface, 0, share) : at_shares(surface, share, 0);
    const Vec3 b = in_u ? at_shares(surface, 1, share) : at_shares(surface, share, 1);
    if ((a - b).norm() > 1e-9 * size) return false;
  }
  return true;
}

std::array<double, 2> periods_of(const Surface& surface) {
  return {closes(surface, true) ? surface.last_u() - surface.first_u() : 0,
          closes(surface, false) ? surface.last_v() - surface.first_v() : 0};
}

Vec2 turns_towards(const Vec2& place, const Vec2& other, const std::array<double, 2>& periods) {
  Vec2 turns = Vec2::Zero();
  for (std::size_t d = 0; d < 2; ++d) {
    const auto k = static_cast<Eigen::Index>(d);
    if (!(periods[d] > 0)) continue;
    const double apart = (other[k] - place[k]) / periods[d];
    if (std::abs(apart) > 0.5 + no_width) turns[k] = periods[d] * std::round(apart);
  }
  return turns;
}

bool begin_at_pole(Loop& loop, const Surface& surface) {
  const double least = 1e-6 * box_of(surface.points).diagonal().norm();
  std::vector<Vec3> poles;
  for (const nurbs::Curve& side : sides_of(surface))
    if (is_point(side, least)) poles.push_back(side.points.front());
  const auto first = std::ranges::find_if(loop.edges, [&](const Edge& edge) {
    if (edge.curve.points.empty()) return false;
    const Vec3 start = at_share(edge.curve, 0);
    return std::ranges::any_of(poles, [&](const Vec3& pole) { return (pole - start).norm() <= least; });
  });
  if (first == loop.edges.end()) return false;
  std::rotate(loop.edges.begin(), first, loop.edges.end());
  return true;
}

std::optional<bool> is_high_side(const Surface& surface, std::size_t across, int turns) {
  const double least = 1e-6 * box_of(surface.points).diagonal().norm();
  const std::array<nurbs::Curve, 4> sides = sides_of(surface);
  const bool low = is_point(sides[2 * across], least), high = is_point(sides[2 * across + 1], least);
  if (!low && !high) return std::nullopt;
  if (low != high) return high;
  return (turns > 0) == (across == 1);
}

Face with_seam_in_gap(Face face) {
  Box3 box;
  for (const Edge& edge : edges_of(face)) {
    if (edge.flat.points.empty()) return face;
    for (const Vec3& p : edge.flat.points) box.extend(p);
  }
  if (face.loops.empty()) return face;
  for (const bool in_u : {true, false}) {
    Surface s = in_u ? face.surface : nurbs::transposed(face.surface);
    const Eigen::Index d = in_u ? 0 : 1;
    const double low = box.min()[d], high = box.max()[d], period = s.last_u() - s.first_u();
    const bool leaves = low < s.first_u() - no_width * period || high > s.last_u() + no_width * period;
    if (!leaves || high - low > (1 + no_width) * period || !closes(s, true)) continue;
    s = opened_at(s, low - 0.5 * std::max(0.0, period - (high - low)));
    face.surface = in_u ? std::move(s) : nurbs::transposed(s);
  }
  return face;
}

}  // namespace selvage::cad
