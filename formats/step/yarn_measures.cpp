#include "formats/step/yarn_measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

}  // namespace selvage::formats::step
