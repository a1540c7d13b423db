#include "cad/sampled_curve.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <limits>

#include "cad/natural_border.h"
#include "nurbs/divided.h"
#include "nurbs/turn.h"

namespace selvage::cad {

namespace {

struct Chord {
  double distance;    // squared
  std::size_t index;  // from this sample to the next one
};

double squared_distance(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double length = along.squaredNorm();
  const double t = length > 0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0.0;
  return (a + t * along - p).squaredNorm();
}

// Nearest first.
std::array<Chord, 4> nearest_chords(const std::vector<Vec3>& points, const Vec3& p) {
  std::array<Chord, 4> found;
  found.fill({std::numeric_limits<double>::infinity(), 0});
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    Chord chord{squared_distance(p, points[k], points[k + 1]), k};
    for (Chord& other : found)
      if (chord.distance < other.distance) std::swap(chord, other);
  }
  return found;
}

// Newton's method for the foot of the perpendicular within a smooth piece. It stays off the piece's ends,
// where the derivatives are the next piece's.
void improve(NearestOnCurve& nearest, const Vec3& p, double from, double to, const nurbs::Curve& curve) {
  double t = (from + to) / 2;
  for (int step = 0; step < 24; ++step) {
    const nurbs::CurveJet at = nurbs::evaluate_jet(curve, t);
    const Vec3 offset = at.position - p;
    const double distance = offset.norm(), speed = at.d1.squaredNorm();
    if (distance < nearest.distance) nearest = {t, distance};
    if (!(speed > 0)) return;
    // Where the curve bends too much for Newton's step, Gauss's leads downhill still.
    const double slope = speed + offset.dot(at.d2);
    double next = t - offset.dot(at.d1) / (slope > 0 ? slope : speed);
    if (!(next > from)) next = (t + from) / 2;
    if (!(next < to)) next = (t + to) / 2;
    if (next == t) return;
    t = next;
  }
}

}  // namespace

std::array<nurbs::Curve, 4> sides_of(const nurbs::Surface& surface) {
  const nurbs::Surface whole = nurbs::clamped(surface);
  return {nurbs::boundary_column(whole, false), nurbs::boundary_column(whole, true),
          nurbs::boundary_row(whole, false), nurbs::boundary_row(whole, true)};
}

Vec3 at_share(const nurbs::Curve& curve, double share) {
  return nurbs::evaluate(curve, std::lerp(curve.first_parameter(), curve.last_parameter(), share));
}

Vec3 at_shares(const nurbs::Surface& surface, double of_u, double of_v) {
  return nurbs::evaluate(surface, std::lerp(surface.first_u(), surface.last_u(), of_u),
                         std::lerp(surface.first_v(), surface.last_v(), of_v));
}

Vec3 at_share(const nurbs::Surface& surface, const nurbs::Curve& flat, double share) {
  const Vec3 p = at_share(flat, share);
  return nurbs::evaluate(surface, p.x(), p.y());
}

bool is_point(const nurbs::Curve& curve, double tolerance) {
  return std::all_of(curve.points.begin(), curve.points.end(),
                     [&](const Vec3& p) { return (p - curve.points.front()).norm() <= tolerance; });
}

bool is_point(const nurbs::Surface& surface, const nurbs::Curve& flat, double tolerance) {
  const Vec3 start = at_share(surface, flat, 0);
  return std::ranges::all_of(std::array{0.31, 0.5, 0.77, 1.0}, [&](double share) {
    return (at_share(surface, flat, share) - start).norm() <= tolerance;
  });
}

SampledCurve::SampledCurve(const nurbs::Curve& sampled) {
  const std::vector<double> breaks = nurbs::breakpoints(sampled.knots, sampled.degree);
  const int parts = breaks.size() < 5 ? 8 : 2;  // of a span
  *this = {sampled, nurbs::divided(breaks, std::vector<int>(breaks.size() - 1, parts))};
}

SampledCurve::SampledCurve(const nurbs::Curve& sampled, std::vector<double> at)
    : curve(&sampled), parameters(std::move(at)) {
  points.reserve(parameters.size());
  for (const double t : parameters) points.push_back(nurbs::evaluate(sampled, t));
}

double SampledCurve::length() const {
  return nurbs::length_of(points);
}

NearestOnCurve SampledCurve::nearest(const Vec3& p, double enough) const {
  std::size_t best = 0;
  for (std::size_t i = 1; i < points.size(); ++i)
    if ((points[i] - p).squaredNorm() < (points[best] - p).squaredNorm()) best = i;
  NearestOnCurve nearest{parameters[best], (points[best] - p).norm()};
  if (nearest.distance == 0) return nearest;
  for (const Chord& chord : nearest_chords(points, p)) {
    if (!std::isfinite(chord.distance)) break;
    improve(nearest, p, parameters[chord.index], parameters[chord.index + 1], *curve);
    if (nearest.distance <= enough) break;
  }
  return nearest;
}

bool flat_holds(const nurbs::Surface& surface, const Edge& edge, double agree) {
  if (edge.flat.points.empty() || edge.curve.points.empty()) return !edge.flat.points.empty();
  const double tolerance = agree * box_of(surface.points).diagonal().norm();
  const SampledCurve sampled(edge.curve);
  return std::ranges::all_of(std::array{0.5, 0.1, 0.3, 0.7, 0.9}, [&](double share) {
    return sampled.nearest(at_share(surface, edge.flat, share), tolerance).distance <= tolerance;
  });
}

double closeness(double size, double largest_coordinate, double resolution) {
  return std::max(std::clamp(resolution, 1e-6 * size, 1e-4 * size), 16 * DBL_EPSILON * largest_coordinate);
}

Polylines border_of(const Face& face, double tolerance) {
  Polylines border;
  const bool is_whole = has_natural_border(face, tolerance);
  if (face.loops.size() > 1 && !is_whole) return border;
  if (is_whole) {
    const std::array<nurbs::Curve, 4> sides = sides_of(face.surface);
    for (std::size_t pair : {0U, 2U}) {
      // Two edges that are one are a seam.
      if (sides[pair].points.size() == sides[pair + 1].points.size() &&
          largest_difference(sides[pair].points, sides[pair + 1].points) <= tolerance)
        continue;
      for (const std::size_t k : {pair, pair + 1})
        if (!is_point(sides[k], tolerance)) border.push_back(SampledCurve(sides[k]).points);
    }
    return border;
  }
  for (const Edge& edge : face.loops.front().edges) {
    if (!edge.curve.points.empty()) {
      border.push_back(SampledCurve(edge.curve).points);
    } else if (!edge.flat.points.empty()) {
      border.push_back(SampledCurve(edge.flat).points);
      for (Vec3& p : border.back()) p = nurbs::evaluate(face.surface, p.x(), p.y());
    }
  }
  return border;
}

bool runs_along(const Polylines& border, const SampledCurve& closed, double tolerance) {
  if (border.empty()) return false;
  double length = 0;
  for (const std::vector<Vec3>& line : border) {
    length += nurbs::length_of(line);
    for (const Vec3& p : line)
      if (closed.nearest(p).distance > tolerance) return false;
  }
  // Polylines of different samples: the lengths differ by their chords.
  return std::abs(length / closed.length() - 1) < 0.1;
}

double largest_difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

}  // namespace selvage::cad
