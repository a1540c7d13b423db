#include "cad/lid.h"

#include <algorithm>
#include <cmath>

#include "cad/natural_border.h"
#include "nurbs/turn.h"
#include "yarn/ends.h"
#include "yarn/grid.h"

namespace selvage::cad {

namespace {

using nurbs::Surface;
using yarn::EndStyle;

bool same_basis(const nurbs::Curve& a, const nurbs::Curve& b) {
  return a.degree == b.degree && a.points.size() == b.points.size();
}

// The largest distance at equal shares of both parameters.
double largest_distance(const nurbs::Curve& a, const nurbs::Curve& b) {
  if (same_basis(a, b) && a.points == b.points) return 0;
  constexpr int steps = 16;
  double largest = 0;
  for (int k = 0; k <= steps; ++k) {
    const auto at = [&](const nurbs::Curve& c) {
      return nurbs::evaluate(c, c.first_parameter() + (c.last_parameter() - c.first_parameter()) * k / steps);
    };
    largest = std::max(largest, (at(a) - at(b)).norm());
  }
  return largest;
}

// The surface with its corner `k` of (0,0), (1,0), (1,1), (0,1) in the place of the first.
Surface with_first_corner(const Surface& surface, std::size_t k) {
  Surface turned = surface;
  if (k == 1 || k == 2) turned = nurbs::reversed_u(turned);
  if (k == 2 || k == 3) turned = nurbs::reversed_v(turned);
  return turned;
}

std::array<Vec3, 4> corners_of(const Surface& s) {
  const int u = s.count_u - 1, v = s.count_v - 1;
  return {s.point(0, 0), s.point(u, 0), s.point(u, v), s.point(0, v)};
}

// A patch over the four quarters of the outline, one corner at the seam.
std::optional<Lid> as_patch(const Surface& surface, const TubeEnd& end) {
  const std::array<Vec3, 4> corners = corners_of(surface);
  std::size_t seam = 0;
  while (seam < 4 && (corners[seam] - end.outline().points.front()).norm() > end.tolerance()) ++seam;
  if (seam == 4) return std::nullopt;
  Surface patch = with_first_corner(surface, seam);
  std::array<double, 4> at{end.first_u(), 0, 0, 0};
  const std::array<Vec3, 4> turned = corners_of(patch);
  for (std::size_t k = 1; k < 4; ++k) {
    const std::optional<double> t = end.parameter_of(turned[k]);
    if (!t) return std::nullopt;
    at[k] = *t;
  }
  if (at[1] > at[3]) {
    patch = nurbs::transposed(patch);
    std::swap(at[1], at[3]);
  }
  if (!(at[0] < at[1] && at[1] < at[2] && at[2] < at[3] && at[3] < end.outline().last_parameter()))
    return std::nullopt;
  Lid lid;
  lid.quarters = at;
  const std::array<nurbs::Curve, 4> sides = nurbs::boundary_round(patch);
  for (std::size_t k = 0; k < 4; ++k) {
    const double last = k < 3 ? at[k + 1] : end.outline().last_parameter();
    lid.gap = std::max(lid.gap, largest_distance(sides[k], nurbs::sub_curve(end.outline(), at[k], last)));
  }
  if (lid.gap > end.tolerance()) return std::nullopt;
  lid.face.style = EndStyle::patch;
  lid.face.surface = std::move(patch);
  return lid;
}

// The published end face: the outline's own row, two between, and the centre.
std::optional<Lid> as_fan(const Surface& surface, const TubeEnd& end) {
  Surface fan = surface;
  const nurbs::Curve& outline = end.outline();
  if (is_point(nurbs::boundary_column(fan, false), end.tolerance()) ||
      is_point(nurbs::boundary_column(fan, true), end.tolerance()))
    fan = nurbs::transposed(fan);
  if (is_point(nurbs::boundary_row(fan, false), end.tolerance())) fan = nurbs::reversed_v(fan);
  if (!is_point(nurbs::boundary_row(fan, true), end.tolerance()) || fan.count_v != 4 || fan.degree_v != 3 ||
      !same_basis(nurbs::boundary_row(fan, false), outline))
    return std::nullopt;
  for (const bool backward : {false, true}) {
    if (backward) fan = nurbs::reversed_u(fan);
    const nurbs::Curve row = nurbs::boundary_row(fan, false);
    const double gap =
        std::max(largest_difference(row.points, outline.points), largest_distance(row, outline));
    if (gap > end.tolerance()) continue;
    Lid lid;
    lid.gap = gap;
    lid.face.style = EndStyle::fan;
    lid.face.surface = std::move(fan);
    return lid;
  }
  return std::nullopt;
}

// A plane that is trimmed by the outline.
bool is_plane_of(const Surface& surface, const nurbs::Curve& outline, double tolerance) {
  const Vec3 area = yarn::area_vector(outline);
  if (!(area.norm() > 0)) return false;
  const Vec3 normal = area.normalized(), origin = outline.points.front();
  double size = 0, largest = 0;
  for (const Vec3& p : outline.points) {
    size = std::max(size, (p - origin).norm());
    largest = std::max(largest, p.cwiseAbs().maxCoeff());
  }
  if (yarn::flatness(outline, origin, normal) > yarn::flat_enough(size, largest)) return false;
  return std::all_of(surface.points.begin(), surface.points.end(),
                     [&](const Vec3& p) { return std::abs((p - origin).dot(normal)) <= tolerance; });
}

bool has_edge(const Face& face, const nurbs::Curve& outline) {
  if (face.loops.size() != 1 || face.loops.front().edges.size() != 1) return false;
  const nurbs::Curve& edge = face.loops.front().edges.front().curve;
  if (!same_basis(edge, outline)) return false;
  return edge.points == outline.points ||
         std::equal(edge.points.begin(), edge.points.end(), outline.points.rbegin());
}

}  // namespace

TubeEnd::TubeEnd(const yarn::Body& body, bool last, double tolerance)
    : outline_(yarn::end_curve(body, last)),
      samples_(outline_),
      usual_(body.quarters),
      tolerance_(tolerance) {}

std::optional<double> TubeEnd::parameter_of(const Vec3& p) const {
  double best = tolerance_;
  std::optional<double> found;
  const auto look = [&](double t, const Vec3& at) {
    if ((at - p).norm() > best || (found && (at - p).norm() == best)) return;
    best = (at - p).norm();
    found = t;
  };
  for (const double t : usual_) look(t, nurbs::evaluate(outline_, t));
  if (found && best == 0) return found;
  for (const double t : nurbs::breakpoints(outline_.knots, outline_.degree))
    if (t < outline_.last_parameter()) look(t, nurbs::evaluate(outline_, t));
  if (found) return found;
  const NearestOnCurve nearest = samples_.nearest(p);
  return nearest.distance <= tolerance_ ? std::optional(nearest.parameter) : std::nullopt;
}

std::optional<Lid> lid_of(const Face& face, const TubeEnd& end) {
  Lid planar;
  planar.face.style = EndStyle::planar;
  if (has_edge(face, end.outline()) && is_plane_of(face.surface, end.outline(), end.tolerance()))
    return planar;
  if (has_natural_border(face, end.tolerance())) {
    if (std::optional<Lid> lid = as_patch(face.surface, end)) return lid;
    if (std::optional<Lid> lid = as_fan(face.surface, end)) return lid;
  }
  if (!runs_along(border_of(face, end.tolerance()), end.samples(), end.tolerance())) return std::nullopt;
  if (!face.loops.empty() && is_plane_of(face.surface, end.outline(), end.tolerance())) return planar;
  return Lid{};
}

}  // namespace selvage::cad
