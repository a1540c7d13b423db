#include "yarn/finish.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "nurbs/basis.h"
#include "nurbs/jets.h"
#include "nurbs/measure.h"
#include "yarn/ends.h"

namespace selvage::yarn {

namespace {

// One third of the flux out of an end as its outline says: as if a plane through `foot` sealed it.
double flat_flux(const Body& body, bool last, const Vec3& foot, const Vec3& origin) {
  const double sign = (last != body.inward) ? 1.0 : -1.0;
  return sign * area_vector(end_curve(body, last)).dot(foot - origin) / 3.0;
}

// As if there were no end faces yet.
double open_flux(const Body& body, bool last, const Vec3& origin) {
  return flat_flux(body, last, end_curve(body, last).points.front(), origin);
}

// No section at v reaches farther: it lies in the hull of the rows of the control net that count there.
double widest_reach(const Body& body, const Vec3& centre, const Vec3& toward, double v) {
  const nurbs::Surface& s = body.surface;
  const int last = nurbs::find_span(s.knots_v, s.degree_v, s.count_v, v);
  double largest = 0.0;
  for (std::size_t k = s.index(0, last - s.degree_v); k < s.index(0, last + 1); ++k)
    largest = std::max(largest, (s.points[k] - centre).dot(toward));
  return largest;
}

// How far the section at v reaches from the axis in the unit direction `toward`.
double reach(const Body& body, const Vec3& centre, const Vec3& toward, double v) {
  const nurbs::Surface& s = body.surface;
  const std::vector<double> breaks = nurbs::breakpoints(s.knots_u, s.degree_u);
  double largest = 0.0;
  for (const Vec3& p : nurbs::evaluate_grid(s, breaks, {v}))
    largest = std::max(largest, (p - centre).dot(toward));
  return largest;
}

// Does the surface go backwards somewhere round the section at v, against its mean way? A bend alone does not
// say so of a grid, whose axis is only a line through the middles of its rows.
bool goes_backwards(const Body& body, double v) {
  const nurbs::Surface& s = body.surface;
  const std::vector<double> breaks = nurbs::breakpoints(s.knots_u, s.degree_u);
  constexpr int looks = 4;
  std::vector<Vec3> ways;
  Vec3 mean = Vec3::Zero();
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
    for (int i = 0; i < looks; ++i) {
      ways.push_back(nurbs::evaluate_jet(s, breaks[k] + (breaks[k + 1] - breaks[k]) * i / looks, v).dv);
      mean += ways.back();
    }
  return std::any_of(ways.begin(), ways.end(), [&](const Vec3& way) { return way.dot(mean) <= 0.0; });
}

void find_bends(Body& body) {
  body.min_bend_radius = std::numeric_limits<double>::infinity();
  // No section reaches farther than the control net does from the axis: most places need no closer look.
  const double widest = widest_section(body);
  const nurbs::Jets axis(body.axis);
  const std::vector<double> breaks = nurbs::breakpoints(body.axis.knots, body.axis.degree);
  constexpr int samples = 8;
  struct Found {
    TightBend bend;
    double ratio;
  };
  std::vector<Found> found;
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    std::optional<Found> worst;  // of this span
    for (int i = 0; i <= samples; ++i) {
      const double t = breaks[k] + (breaks[k + 1] - breaks[k]) * i / samples;
      const nurbs::CurveJet jet = axis.at(t);
      const double speed = jet.d1.squaredNorm();
      if (speed == 0.0) continue;
      const Vec3 curvature = (jet.d2 - jet.d1 * (jet.d2.dot(jet.d1) / speed)) / speed;
      const double kappa = curvature.norm();
      // What rounding makes of a straight line is no bend.
      if (kappa * body.length > 1e-9) body.min_bend_radius = std::min(body.min_bend_radius, 1.0 / kappa);
      if (kappa * widest <= 1.0) continue;
      if (kappa * widest_reach(body, jet.position, curvature / kappa, t) < 1.0 - 1e-9) continue;
      const double needed = reach(body, jet.position, curvature / kappa, t);
      if (needed * kappa >= 1.0 && (!worst || needed * kappa > worst->ratio) && goes_backwards(body, t))
        worst = Found{{t, jet.position, 1.0 / kappa, needed}, needed * kappa};
    }
    if (!worst) continue;
    // Neighbouring spans that meet in their worst point have one bend.
    if (!found.empty() && found.back().bend.parameter == worst->bend.parameter) found.pop_back();
    found.push_back(*worst);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Found& a, const Found& b) { return a.ratio > b.ratio; });
  for (const Found& f : found) body.tight_bends.push_back(f.bend);
  if (found.empty()) return;
  const TightBend& bend = found.front().bend;
  body.messages.push_back(
      warning(
          Kind::geometry,
          fmt::format("yarn '{}' bends more tightly than its section allows: radius {:.4g} where the section "
                      "reaches {:.4g} to the inside ({} such place{}); its surface folds over itself there",
                      body.name, bend.radius, bend.needed, found.size(), found.size() == 1 ? "" : "s"))
          .of_yarn(body.name, body.place)
          .at_point(bend.at));
}

// Finds which way the body's normals point, with open ends: S_u x S_v outward makes the flux positive.
// Returns the flux of the side alone.
Result<double> orient(Body& body) {
  body.shape = 0;  // whatever it was made of
  body.at = Vec3::Zero();
  const Vec3 origin = body.axis.points.front();
  body.inward = false;
  const double side = nurbs::volume_flux(body.surface, origin);
  double flux = side;
  if (!body.closed_along) flux += open_flux(body, false, origin) + open_flux(body, true, origin);
  if (!std::isfinite(flux) || flux == 0.0)
    return error(Kind::geometry, fmt::format("yarn '{}' encloses no volume", body.name))
        .of_yarn(body.name, body.place);
  body.inward = flux < 0.0;
  return side;
}

// `side`: from orient().
void measure(Body& body, double side) {
  const Vec3 origin = body.axis.points.front();
  body.volume = body.inward ? -side : side;
  if (!body.closed_along) body.volume += end_flux(body, false, origin) + end_flux(body, true, origin);
  body.end_area = area_vector(end_curve(body, false)).norm();
  body.length = nurbs::arc_length(body.axis);
  find_bends(body);
}

}  // namespace

double end_flux(const Body& body, bool last, const Vec3& origin) {
  const EndFace& end = last ? body.end : body.start;
  if (end.style == EndStyle::patch || end.style == EndStyle::fan) {
    const double flux = nurbs::volume_flux(end.surface, origin);
    return end.inward ? -flux : flux;
  }
  return end.style == EndStyle::none ? open_flux(body, last, origin)
                                     : flat_flux(body, last, end.origin, origin);
}

void move(Body& body, const Vec3& by, const DecimalGrid& grid) {
  const Vec3 step = grid.rounded(by);
  nurbs::Surface& surface = body.surface;
  const auto columns = static_cast<std::size_t>(surface.count_u);
  const auto moved = [&](const Vec3& p) { return grid.rounded(Vec3(p + step)); };
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    Vec3& p = surface.points[i];
    // A row at an oblique end stands on its plane, on no grid.
    const bool is_end = i < columns || i + columns >= surface.points.size();
    p = is_end && grid.rounded(p) != p ? Vec3(p + step) : moved(p);
  }
  for (Vec3& p : body.axis.points) p += by;
  for (const bool last : {false, true}) {
    EndFace& end = last ? body.end : body.start;
    end.origin += step;
    for (Vec3& p : end.surface.points) p += step;  // a fan's centre is no point of the outline
    renew_end(body, last);
  }
  for (TightBend& bend : body.tight_bends) bend.at += by;
  for (Message& message : body.messages)
    if (message.at) *message.at += by;
  body.at += by;
}

namespace {

// The same surface with u run backwards.
void reverse_u(nurbs::Surface& surface) {
  const auto columns = static_cast<std::ptrdiff_t>(surface.count_u);
  for (auto row = surface.points.begin(); row != surface.points.end(); row += columns)
    std::reverse(row, row + columns);
  for (auto row = surface.weights.begin(); row != surface.weights.end(); row += columns)
    std::reverse(row, row + columns);
  surface.knots_u = nurbs::reversed_knots(surface.knots_u);
}

void swap_u_and_v(nurbs::Surface& surface) {
  const nurbs::Surface old = surface;
  std::swap(surface.degree_u, surface.degree_v);
  std::swap(surface.count_u, surface.count_v);
  std::swap(surface.knots_u, surface.knots_v);
  for (int j = 0; j < surface.count_v; ++j)
    for (int i = 0; i < surface.count_u; ++i) {
      surface.point(i, j) = old.point(j, i);
      if (old.is_rational()) surface.weights[surface.index(i, j)] = old.weight(j, i);
    }
}

// The quarters of the end curve follow each other in the other order, from the same seam.
void mirror_outline(Body& body) {
  const double both = body.surface.first_u() + body.surface.last_u();
  reverse_u(body.surface);
  const std::array<double, 4> quarters = body.quarters;
  for (std::size_t i = 1; i < 4; ++i) body.quarters[i] = both - quarters[4 - i];
  for (EndFace* end : {&body.start, &body.end}) {
    if (end->style == EndStyle::patch) swap_u_and_v(end->surface);
    if (end->style == EndStyle::fan) reverse_u(end->surface);
  }
}

}  // namespace

void map_rigidly(Body& body, const Eigen::Matrix3d& linear, const Vec3& by) {
  const auto map = [&](Vec3& p) { p = linear * p + by; };
  std::array<bool, 2> is_standard{};
  for (const bool last : {false, true})
    if (const EndStyle style = (last ? body.end : body.start).style;
        style == EndStyle::patch || style == EndStyle::fan)
      is_standard[last ? 1 : 0] = is_standard_end(body, last);
  for (std::vector<Vec3>* points :
       {&body.surface.points, &body.axis.points, &body.start.surface.points, &body.end.surface.points})
    std::for_each(points->begin(), points->end(), map);
  for (EndFace* end : {&body.start, &body.end}) {
    map(end->origin);
    end->normal = linear * end->normal;
  }
  for (TightBend& bend : body.tight_bends) map(bend.at);
  for (Message& message : body.messages)
    if (message.at) map(*message.at);
  map(body.at);
  if (linear.determinant() < 0.0) {
    mirror_outline(body);
    body.twist = -body.twist;
  }
  // What is made of the outline has the numbers of the outline.
  for (const bool last : {false, true})
    if (is_standard[last ? 1 : 0]) renew_end(body, last);
}

Status finish(Body& body, const Sealings& ends) {
  const Result<double> side = orient(body);
  if (!side) return side.error();
  if (Status sealed = seal(body, ends); !sealed) return sealed;
  measure(body, *side);
  return {};
}

Status finish(Body& body, EndStyle ends) {
  return finish(body, both_ends(ends));
}

Status finish_as_sealed(Body& body) {
  const Result<double> side = orient(body);
  if (!side) return side.error();
  for (const bool last : {false, true})
    if (!body.closed_along && (last ? body.end : body.start).style != EndStyle::none)
      if (Status completed = complete_end(body, last); !completed) return completed;
  measure(body, *side);
  return {};
}

}  // namespace selvage::yarn
