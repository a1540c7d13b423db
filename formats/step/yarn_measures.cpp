#include "formats/step/yarn_measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "nurbs/bezier.h"
#include "nurbs/divided.h"
#include "yarn/ends.h"

namespace selvage::formats::step {

namespace {

using nurbs::Moments;
using yarn::EndStyle;

// Two places nearer than this share of the yarn's thickness are one place.
constexpr double same_place = 1e-7;
// The area vectors of a closed body's faces add up to 0: to rounding, and to what its ends may stand off.
constexpr double same_direction = 1e-5;
// Yarns that lie on each other to this share of their thickness measure the same: their places have been
// rounded.
constexpr double same_shape = 1e-11;
// What is kept of yarns to compare others with, control points: 1.5 MB, or two of the largest yarns.
constexpr std::size_t most_points = std::size_t{1} << 16U;

bool is_number(const nurbs::Surface& surface) {
  const auto finite = [](double value) { return std::isfinite(value); };
  return std::all_of(surface.points.begin(), surface.points.end(),
                     [](const Vec3& p) { return p.allFinite(); }) &&
         std::all_of(surface.weights.begin(), surface.weights.end(), finite) &&
         std::all_of(surface.knots_u.begin(), surface.knots_u.end(), finite) &&
         std::all_of(surface.knots_v.begin(), surface.knots_v.end(), finite);
}

double thickness_of(const yarn::Body& body) {
  if (body.end_area > 0) return std::sqrt(body.end_area);
  return 0.1 * yarn::bounds(body).diagonal().norm();
}

// The part of a plane inside the end curve, as a cone of no height: its moments are the plane's whatever the
// apex.
nurbs::Surface disc(const nurbs::Curve& outline, const Vec3& centre) {
  nurbs::Curve apex = outline;
  for (Vec3& point : apex.points) point = centre;
  nurbs::Surface disc;
  disc.degree_u = outline.degree;
  disc.degree_v = 1;
  disc.count_u = static_cast<int>(outline.points.size());
  disc.count_v = 2;
  disc.knots_u = outline.knots;
  disc.knots_v = {0, 0, 1, 1};
  for (const nurbs::Curve& row : {apex, outline}) {
    disc.points.insert(disc.points.end(), row.points.begin(), row.points.end());
    disc.weights.insert(disc.weights.end(), row.weights.begin(), row.weights.end());
  }
  return disc;
}

// A closed curve in the plane across `normal`, each span (of a rational one or one above degree 3 each
// sixteenth of it) as the cubic with its ends and tangents there: exact up to degree 3.
std::vector<nurbs::Bezier> beziers_of(const nurbs::Curve& curve, const Vec3& normal) {
  const Vec3 x = normal.unitOrthogonal(), y = normal.cross(x);
  const auto flat = [&](const Vec3& p) { return Vec2(p.dot(x), p.dot(y)); };
  const int parts = curve.is_rational() || curve.degree > 3 ? 16 : 1;
  const std::vector<double> breaks = nurbs::breakpoints(curve.knots, curve.degree);
  std::vector<nurbs::Bezier> beziers;
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    const nurbs::Curve span = nurbs::sub_curve(curve, breaks[k], breaks[k + 1]);
    const double third = (breaks[k + 1] - breaks[k]) / parts / 3;
    nurbs::CurveJet from = nurbs::evaluate_jet(span, breaks[k]);
    for (int part = 1; part <= parts; ++part) {
      const nurbs::CurveJet to =
          nurbs::evaluate_jet(span, part == parts ? breaks[k + 1] : breaks[k] + 3 * third * part);
      beziers.push_back({flat(from.position), flat(from.position + third * from.d1),
                         flat(to.position - third * to.d1), flat(to.position)});
      from = to;
    }
  }
  // Joined to the bit.
  for (std::size_t k = 0; k < beziers.size(); ++k) beziers[k][3] = beziers[(k + 1) % beziers.size()][0];
  return beziers;
}

// Does every ray from the centre meet the control polygon once? Then it meets the curve once, too: no line
// meets a B-spline more often than its polygon.
bool is_round(const nurbs::Curve& outline, const Vec3& centre, const Vec3& normal) {
  double turned = 0;
  int sign = 0;
  for (std::size_t k = 0; k + 1 < outline.points.size(); ++k) {
    const Vec3 a = outline.points[k] - centre, b = outline.points[k + 1] - centre;
    const double sine = a.cross(b).dot(normal);
    if (a == b) continue;
    if (sine == 0 || (sign != 0 && (sine > 0) != (sign > 0))) return false;
    sign = sine > 0 ? 1 : -1;
    turned += std::atan2(std::abs(sine), a.dot(b));
  }
  return turned < 3 * std::numbers::pi;
}

// Where the outline of a plane end face crosses or touches itself.
std::optional<Vec3> crossing_of(const yarn::Body& body, bool last) {
  const yarn::EndFace& end = last ? body.end : body.start;
  if (end.style != EndStyle::planar) return std::nullopt;
  const nurbs::Curve outline = yarn::end_curve(body, last);
  if (is_round(outline, end.origin, end.normal)) return std::nullopt;
  const auto crossing = nurbs::find_crossing(beziers_of(outline, end.normal));
  if (!crossing) return std::nullopt;
  const Vec3 x = end.normal.unitOrthogonal(), y = end.normal.cross(x);
  return crossing->at.x() * x + crossing->at.y() * y + end.origin.dot(end.normal) * end.normal;
}

// By the normal that points out of the yarn.
Moments moments_of_end(const yarn::Body& body, bool last, const Vec3& origin, double area_error) {
  const yarn::EndFace& end = last ? body.end : body.start;
  if (end.style != EndStyle::planar) {
    const Moments own = nurbs::moments(end.surface, origin, area_error);
    return end.inward ? own.turned() : own;
  }
  const nurbs::Curve outline = yarn::end_curve(body, last);
  Moments flat = nurbs::moments(disc(outline, end.origin), origin, area_error);
  flat.area = flat.area_vector.norm();
  return flat.area_vector.dot(end.normal) < 0 ? flat.turned() : flat;
}

}  // namespace

Result<YarnMeasures> measured(const yarn::Body& body) {
  const auto refused = [&](const std::string& why, const Vec3& at) {
    return error(Kind::geometry, fmt::format("yarn '{}'{}", body.name, why), about(body, at));
  };
  for (const nurbs::Surface* surface : {&body.surface, &body.start.surface, &body.end.surface})
    if (!is_number(*surface))
      return error(Kind::geometry,
                   fmt::format("yarn '{}' has a control point, knot or weight that is no number", body.name),
                   about(body));
  YarnMeasures measures;
  measures.is_closed = true;
  const Vec3 origin = yarn::bounds(body).center();
  Moments sum = nurbs::moments(body.surface, origin);
  if (body.inward) sum = sum.turned();
  const double area_error = 1e-11 * sum.area;
  for (const bool last : {false, true}) {
    if (body.closed_along) break;
    const yarn::EndFace& end = last ? body.end : body.start;
    const char* const which = last ? "end" : "start";
    if (end.style == EndStyle::none) {
      measures.is_closed = false;
      continue;
    }
    if (const double gap = yarn::end_gap(body, last); !(gap <= same_place * thickness_of(body)))
      return refused(
          fmt::format(": its {} face stands {:.3g} off the body's {} curve, so it does not close the yarn; "
                      "build the ends anew from the body, or check the points of that end",
                      which, gap, which),
          end.origin);
    if (const std::optional<Vec3> crossing = crossing_of(body, last))
      return refused(
          fmt::format(": the outline at its {} crosses itself, so no plane face can close it; look for a "
                      "section that crosses itself at this end",
                      which),
          *crossing);
    sum += moments_of_end(body, last, origin, area_error);
  }
  measures.area = sum.area;
  if (!measures.is_closed) return measures;
  if (!(sum.area_vector.norm() <= same_direction * sum.area))
    return refused(
        ": a face is turned inside out against its neighbour; let the sections of the grid run round all "
        "in one direction",
        body.start.origin);
  if (!(sum.volume > 0))
    return refused(
        fmt::format(" is inside out: its volume is {:.6g}; let the sections run round the path the other "
                    "way",
                    sum.volume),
        body.start.origin);
  measures.volume = sum.volume;
  measures.centre = origin + sum.first / sum.volume;
  return measures;
}

Result<YarnMeasures> MeasuredYarns::of(const yarn::Body& body) {
  const yarn::Invariants invariants = yarn::invariants_of(body);
  const double tolerance = same_shape * thickness_of(body);
  for (const Known& known : known_) {
    if (known.body.quarters != body.quarters || !yarn::are_alike(known.invariants, invariants, tolerance))
      continue;
    if (const auto congruence = yarn::congruence(known.body, body, tolerance)) {
      YarnMeasures measures = known.measures;
      measures.centre = congruence->motion(measures.centre);
      return measures;
    }
  }
  Result<YarnMeasures> measures = measured(body);
  const std::size_t points = body.surface.points.size();
  if (!measures) return measures;
  // Two of the largest yarns have room, whatever their size.
  for (; !known_.empty() && points_ + points > std::max(most_points, 2 * points); known_.pop_front())
    points_ -= known_.front().body.surface.points.size();
  known_.push_back({body, invariants, *measures});
  points_ += points;
  return measures;
}

}  // namespace selvage::formats::step
