#include "cad/feet.h"

#include <algorithm>
#include <cmath>

#include "cad/edges.h"
#include "cad/sampled_curve.h"
#include "cad/seam.h"
#include "nurbs/basis.h"
#include "nurbs/chain.h"
#include "nurbs/divided.h"
#include "nurbs/hermite.h"

namespace selvage::cad {

namespace {

using nurbs::Curve;
using nurbs::Surface;

double extent_of(const Surface& s) {
  return std::max(s.last_u() - s.first_u(), s.last_v() - s.first_v());
}

}  // namespace

Feet::Feet(const Surface& surface) : surface_(surface), periods_(periods_of(surface)) {
  const double size = box_of(surface.points).diagonal().norm();
  least_ = {1e-7 * size / (surface.last_u() - surface.first_u()),
            1e-7 * size / (surface.last_v() - surface.first_v())};
}

Vec2 Feet::of(const Vec3& p, const std::optional<Vec2>& before) {
  if (before) {
    Vec2 at = *before;
    for (int round = 0; round < 8; ++round) {
      const std::optional<Vec2> step = step_towards(p, at);
      if (!step) break;
      at = within(at + *step);
      if (step->cwiseAbs().maxCoeff() < 1e-13 * extent_of(surface_)) return at;
    }
  }
  if (!set_) set_.emplace(std::vector<const Surface*>{&surface_});
  const SurfaceSet::Foot foot = set_->near(p);
  const Vec2 at(foot.u, foot.v);
  return before ? Vec2(at + turns_towards(at, *before, periods_)) : at;
}

Vec2 Feet::of_end(const Vec3& p, const Vec2& beside) {
  const Vec2 at = of(p, beside);
  const nurbs::SurfaceJet here = jet(at), near = jet(beside);
  return {here.du.norm() < 1e-6 * near.du.norm() ? beside.x() : at.x(),
          here.dv.norm() < 1e-6 * near.dv.norm() ? beside.y() : at.y()};
}

std::optional<Vec2> Feet::step_towards(const Vec3& p, const Vec2& at) const {
  const nurbs::SurfaceJet here = jet(at);
  const Vec3 offset = p - here.position;
  const double u = here.du.norm(), v = here.dv.norm();
  if (u > least_[0] && v > least_[1]) return direction(at, offset);
  // Beside a pole it stays in the direction that is open there.
  if (u > least_[0]) return Vec2(offset.dot(here.du) / (u * u), 0);
  if (v > least_[1]) return Vec2(0, offset.dot(here.dv) / (v * v));
  return std::nullopt;
}

std::optional<Vec2> Feet::direction(const Vec2& at, const Vec3& step) const {
  const nurbs::SurfaceJet here = jet(at);
  const double uu = here.du.squaredNorm(), uv = here.du.dot(here.dv), vv = here.dv.squaredNorm();
  const double det = uu * vv - uv * uv;
  if (!(det > 1e-24 * uu * vv)) return std::nullopt;
  const double a = step.dot(here.du), b = step.dot(here.dv);
  return Vec2((vv * a - uv * b) / det, (uu * b - uv * a) / det);
}

nurbs::SurfaceJet Feet::jet(const Vec2& at) const {
  return nurbs::evaluate_jet(surface_, inside(at.x(), 0), inside(at.y(), 1));
}

double Feet::inside(double value, std::size_t d) const {
  const double first = d == 0 ? surface_.first_u() : surface_.first_v();
  return periods_[d] > 0 ? value - periods_[d] * std::floor((value - first) / periods_[d]) : value;
}

Vec2 Feet::within(Vec2 at) const {
  if (periods_[0] == 0) at.x() = std::clamp(at.x(), surface_.first_u(), surface_.last_u());
  if (periods_[1] == 0) at.y() = std::clamp(at.y(), surface_.first_v(), surface_.last_v());
  return at;
}

CurveFeet::CurveFeet(Feet& feet, const Curve& curve) : surface_(feet), curve_(curve) {
  constexpr int looks = 64;
  const double first = curve.first_parameter(), last = curve.last_parameter();
  for (int i = 0; i < looks; ++i)
    for (const int side : {1, -1}) at(std::lerp(first, last, 0.5 + side * 0.5 * i / looks));
  const Vec2 start = feet.of_end(nurbs::evaluate(curve, first), this->first());
  const Vec2 end = feet.of_end(nurbs::evaluate(curve, last), this->last());
  feet_.emplace(first, start);
  feet_.emplace(last, end);
}

Vec2 CurveFeet::at(double t) {
  const auto after = feet_.lower_bound(t);
  if (after != feet_.end() && after->first == t) return after->second;
  std::optional<Vec2> beside;
  if (after != feet_.end()) beside = after->second;
  if (after != feet_.begin() && (!beside || t - std::prev(after)->first < after->first - t))
    beside = std::prev(after)->second;
  Vec2 foot = surface_.of(nurbs::evaluate(curve_, t), beside);
  feet_.emplace(t, foot);
  return foot;
}

std::optional<Vec2> CurveFeet::derivative(double t) {
  return surface_.direction(at(t), nurbs::evaluate_jet(curve_, t).d1);
}

namespace {

// The curve in the parameters of a parallelogram, which is the one in space under an affine map; none for
// other surfaces.
std::optional<Curve> flat_on_parallelogram(const Surface& s, const Curve& curve) {
  if (s.degree_u != 1 || s.degree_v != 1 || s.count_u != 2 || s.count_v != 2 || s.is_rational())
    return std::nullopt;
  const Vec3 &a = s.points[0], x = s.points[1] - a, y = s.points[2] - a;
  const double size = x.norm() + y.norm(), xx = x.dot(x), xy = x.dot(y), yy = y.dot(y);
  const double determinant = xx * yy - xy * xy;
  if ((s.points[3] - a - x - y).norm() > 1e-12 * size || !(determinant > 1e-12 * xx * yy))
    return std::nullopt;
  Curve flat = curve;
  for (Vec3& p : flat.points) {
    const double px = (p - a).dot(x), py = (p - a).dot(y);
    const double u = (yy * px - xy * py) / determinant, v = (xx * py - xy * px) / determinant;
    p = {std::lerp(s.first_u(), s.last_u(), u), std::lerp(s.first_v(), s.last_v(), v), 0};
  }
  return flat;
}

Vec3 lifted(const Vec2& p) {
  return {p.x(), p.y(), 0};
}

class FlatFit {
 public:
  FlatFit(Feet& feet, const Curve& curve, double tolerance)
      : feet_(feet), curve_(curve), tolerance_(tolerance), along_(feet, curve) {
    for (const double t : nurbs::divided(curve.knots, curve.degree, 2, 32))
      tolerance_ = std::max(tolerance_, (feet.jet(along_.at(t)).position - nurbs::evaluate(curve, t)).norm());
  }

  std::optional<Curve> curve() {
    if (tolerance_ > curves_agree * box_of(feet_.surface().points).diagonal().norm()) return std::nullopt;
    std::vector<double> at = nurbs::divided(curve_.knots, curve_.degree, curve_.degree == 1 ? 1 : 2, 4);
    for (int round = 0; round < most_rounds && at.size() < most_nodes; ++round) {
      const Curve flat = through(at);
      std::vector<double> finer = {at.front()};
      for (std::size_t k = 0; k + 1 < at.size(); ++k) {
        if (!holds(flat, at[k], at[k + 1])) finer.push_back(0.5 * (at[k] + at[k + 1]));
        finer.push_back(at[k + 1]);
      }
      if (finer.size() == at.size()) return flat;
      at = std::move(finer);
    }
    return std::nullopt;
  }

 private:
  static constexpr int most_rounds = 18;
  static constexpr std::size_t most_nodes = 4096;

  Curve through(const std::vector<double>& at) {
    std::vector<Vec3> points, derivatives;
    for (std::size_t i = 0; i < at.size(); ++i) {
      points.push_back(lifted(along_.at(at[i])));
      // At a pole as just beside it.
      const double beside =
          i + 1 < at.size() ? at[i] + 1e-3 * (at[i + 1] - at[i]) : at[i] - 1e-3 * (at[i] - at[i - 1]);
      std::optional<Vec2> derivative = along_.derivative(at[i]);
      if (!derivative || !derivative->allFinite()) derivative = along_.derivative(beside);
      derivatives.push_back(lifted(derivative.value_or(Vec2::Zero())));
    }
    return nurbs::through_derivatives(at, points, derivatives);
  }

  bool holds(const Curve& flat, double from, double to) {
    return std::ranges::all_of(std::array{0.5, 0.25, 0.75}, [&](double share) {
      const double t = std::lerp(from, to, share);
      const Vec3 here = feet_.jet(nurbs::evaluate(flat, t).head<2>()).position;
      return (here - feet_.jet(along_.at(t)).position).norm() <= tolerance_;
    });
  }

  Feet& feet_;
  const Curve& curve_;
  double tolerance_;
  CurveFeet along_;
};

void shift(Curve& flat, const Vec2& by) {
  for (Vec3& p : flat.points) p.head<2>() += by;
}

constexpr double one_place = 1e-6;   // of the range: what is within it is one place
constexpr double widest_gap = 1e-3;  // of the surface's size: what leaves more between its edges is no loop
constexpr double shortest_pole = 1e-3;  // of the range: what is shorter is a gap that the file leaves

// Are both within this share of the range of each other?
bool are_within(const Surface& s, double share, const Vec3& a, const Vec3& b) {
  return std::abs(a.x() - b.x()) <= share * (s.last_u() - s.first_u()) &&
         std::abs(a.y() - b.y()) <= share * (s.last_v() - s.first_v());
}

// Brought into the range of the surface: by whole turns, and to a side that it misses by nothing. False where
// it does not fit.
bool bring_in(std::vector<Curve>& flats, const Surface& surface, const std::array<double, 2>& periods) {
  const std::array<double, 2> first = {surface.first_u(), surface.first_v()},
                              last = {surface.last_u(), surface.last_v()};
  for (std::size_t d = 0; d < 2; ++d) {
    const auto k = static_cast<Eigen::Index>(d);
    double low = flats.front().points.front()[k], high = low;
    for (const Curve& flat : flats)
      for (const Vec3& p : flat.points) {
        low = std::min(low, p[k]);
        high = std::max(high, p[k]);
      }
    const double slack =
        1e-4 * (last[d] - first[d]);  // of control points: cubics swing beyond what they join
    const double turn = periods[d] > 0 ? -periods[d] * std::floor((low - first[d] + slack) / periods[d]) : 0;
    if (low + turn < first[d] - slack || high + turn > last[d] + slack) return false;
    for (Curve& flat : flats)
      for (Vec3& p : flat.points) p[k] = std::clamp(p[k] + turn, first[d], last[d]);
  }
  return true;
}

// Between an edge's end in space and the next one's start.
double largest_gap(const Loop& loop, const Surface& surface) {
  const auto at = [&](const Edge& edge, double share) {
    return edge.curve.points.empty() ? at_share(surface, edge.flat, share) : at_share(edge.curve, share);
  };
  double gap = 0;
  for (std::size_t i = 0; i < loop.edges.size(); ++i)
    gap = std::max(gap, (at(loop.edges[i], 1) - at(loop.edges[(i + 1) % loop.edges.size()], 0)).norm());
  return gap;
}

void give_flats(Loop& loop, Feet& feet, double tolerance) {
  // Poles are made anew: the file's own go by its own surface's parameters.
  Loop given;
  for (const Edge& edge : loop.edges)
    if (!edge.curve.points.empty() ||
        (!edge.flat.points.empty() && !is_point(feet.surface(), edge.flat, tolerance)))
      given.edges.push_back(edge);
  std::vector<Curve> flats;
  for (const Edge& edge : given.edges) {
    std::optional<Curve> flat =
        edge.flat.points.empty() ? flat_along(feet, edge.curve, tolerance) : std::optional(edge.flat);
    if (!flat) return;
    if (!flats.empty()) {
      const Vec2 start = at_share(*flat, 0).head<2>(), last = at_share(flats.back(), 1).head<2>();
      shift(*flat, turns_towards(start, last, feet.periods()));
    }
    flats.push_back(std::move(*flat));
  }
  if (flats.empty() || !bring_in(flats, feet.surface(), feet.periods())) return;
  for (std::size_t i = 0; i < flats.size(); ++i) given.edges[i].flat = std::move(flats[i]);
  // As far as the file leaves its edges apart.
  const double gap = largest_gap(given, feet.surface());
  if (gap > widest_gap * box_of(feet.surface().points).diagonal().norm()) return;
  const double apart = 2 * gap + tolerance;
  give_poles(given, feet.surface(), apart);
  for (std::size_t i = 0; i < given.edges.size(); ++i) {
    const Curve &flat = given.edges[i].flat, &next = given.edges[(i + 1) % given.edges.size()].flat;
    if (!are_within(feet.surface(), one_place, at_share(flat, 1), at_share(next, 0)) &&
        !is_point(feet.surface(), nurbs::segment(at_share(flat, 1), at_share(next, 0)), apart))
      return;
  }
  loop = std::move(given);
}

}  // namespace

std::optional<Curve> flat_along(Feet& feet, const Curve& curve, double tolerance) {
  if (std::optional<Curve> flat = flat_on_parallelogram(feet.surface(), curve)) return flat;
  return FlatFit(feet, curve, tolerance).curve();
}

void give_flats(Face& face, double tolerance) {
  std::optional<Feet> feet;
  for (Edge& edge : boundary_edges_of(face))
    if (edge.flat.points.empty() && !edge.curve.points.empty())
      edge.flat = flat_on_parallelogram(face.surface, edge.curve).value_or(Curve{});
  for (Loop& loop : face.loops) {
    if (std::ranges::none_of(loop.edges, [](const Edge& edge) { return edge.flat.points.empty(); })) continue;
    if (!feet) feet.emplace(face.surface);
    give_flats(loop, *feet, tolerance);
  }
}

void give_poles(Loop& loop, const Surface& surface, double tolerance) {
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < loop.edges.size(); ++i) {
    edges.push_back(loop.edges[i]);
    const Vec3 to = at_share(loop.edges[i].flat, 1),
               from = at_share(loop.edges[(i + 1) % loop.edges.size()].flat, 0);
    if (are_within(surface, shortest_pole, to, from)) continue;
    nurbs::Curve between = nurbs::segment(to, from);
    if (is_point(surface, between, tolerance)) edges.push_back({.curve = {}, .flat = std::move(between)});
  }
  loop.edges = std::move(edges);
}

}  // namespace selvage::cad
