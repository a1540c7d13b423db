#include "yarn/ends.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/number_text.h"
#include "nurbs/basis.h"
#include "yarn/rigid_fit.h"

namespace selvage::yarn {

namespace {

// The same curve over [0, 1].
nurbs::Curve over_unit(nurbs::Curve curve) {
  const double first = curve.first_parameter(), length = curve.last_parameter() - first;
  for (double& knot : curve.knots) knot = (knot - first) / length;
  return curve;
}

// Brings two curves over [0, 1] of equal degree to the union of their knots. Knots nearer than 1e-9 are taken
// for one.
void unite_knots(nurbs::Curve& a, nurbs::Curve& b) {
  const auto add_missing = [](const nurbs::Curve& from, nurbs::Curve& to) {
    std::size_t j = 0;
    for (double knot : std::vector<double>(from.knots)) {
      while (j < to.knots.size() && to.knots[j] < knot - 1e-9) ++j;
      if (j < to.knots.size() && std::abs(to.knots[j] - knot) <= 1e-9) {
        ++j;
      } else {
        to = nurbs::insert_knot(to, knot);
        ++j;
      }
    }
  };
  add_missing(a, b);
  add_missing(b, a);
  b.knots = a.knots;
}

}  // namespace

nurbs::Surface coons_patch(const std::array<nurbs::Curve, 4>& quarters) {
  nurbs::Curve bottom = over_unit(quarters[0]), right = over_unit(quarters[1]);
  nurbs::Curve top = over_unit(nurbs::reversed(quarters[2])), left = over_unit(nurbs::reversed(quarters[3]));
  unite_knots(bottom, top);
  unite_knots(left, right);
  nurbs::Surface patch;
  patch.degree_u = bottom.degree;
  patch.degree_v = left.degree;
  patch.knots_u = bottom.knots;
  patch.knots_v = left.knots;
  patch.count_u = static_cast<int>(bottom.points.size());
  patch.count_v = static_cast<int>(left.points.size());
  const std::vector<double> s = nurbs::greville(patch.knots_u, patch.degree_u, patch.count_u);
  const std::vector<double> t = nurbs::greville(patch.knots_v, patch.degree_v, patch.count_v);
  const bool rational = bottom.is_rational();
  const std::size_t nu = s.size(), nv = t.size();
  const nurbs::Vec4 c00 = homogeneous(bottom, 0), c10 = homogeneous(bottom, nu - 1);
  const nurbs::Vec4 c01 = homogeneous(top, 0), c11 = homogeneous(top, nu - 1);
  for (std::size_t j = 0; j < nv; ++j)
    for (std::size_t i = 0; i < nu; ++i) {
      // The four sides are taken as they are, to the bit; only the inside is computed.
      const bool is_row = j == 0 || j == nv - 1;
      if (is_row || i == 0 || i == nu - 1) {
        const nurbs::Curve& side = is_row ? (j == 0 ? bottom : top) : i == 0 ? left : right;
        patch.points.push_back(side.points[is_row ? i : j]);
        if (rational) patch.weights.push_back(side.weight(is_row ? i : j));
        continue;
      }
      const double a = s[i], b = t[j];
      const nurbs::Vec4 p = (1 - b) * homogeneous(bottom, i) + b * homogeneous(top, i) +
                            (1 - a) * homogeneous(left, j) + a * homogeneous(right, j) -
                            ((1 - a) * (1 - b) * c00 + a * (1 - b) * c10 + (1 - a) * b * c01 + a * b * c11);
      patch.points.emplace_back(rational ? Vec3(p.head<3>() / p.w()) : Vec3(p.head<3>()));
      if (rational) patch.weights.push_back(p.w());
    }
  return patch;
}

nurbs::Surface fan(const nurbs::Curve& boundary, const Vec3& centre) {
  nurbs::Surface face;
  face.degree_u = boundary.degree;
  face.degree_v = 3;
  face.knots_u = boundary.knots;
  face.knots_v = {0, 0, 0, 0, 1, 1, 1, 1};
  face.count_u = static_cast<int>(boundary.points.size());
  face.count_v = 4;
  face.points = boundary.points;
  for (int row = 1; row < 4; ++row)
    for (const Vec3& p : boundary.points)
      face.points.push_back(row == 3 ? centre : Vec3(p + (centre - p) * (row / 3.0)));
  for (int row = 0; row < 4 && boundary.is_rational(); ++row)
    face.weights.insert(face.weights.end(), boundary.weights.begin(), boundary.weights.end());
  return face;
}

bool is_folded(const nurbs::Surface& patch, const Vec3& normal) {
  const std::vector<double> us = nurbs::breakpoints(patch.knots_u, patch.degree_u);
  const std::vector<double> vs = nurbs::breakpoints(patch.knots_v, patch.degree_v);
  constexpr int samples = 4;
  const auto inside = [](const std::vector<double>& breaks) {
    std::vector<double> sites;
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
      for (int i = 0; i < samples; ++i)
        sites.push_back(breaks[k] + (breaks[k + 1] - breaks[k]) * (i + 0.5) / samples);
    return sites;
  };
  for (double v : inside(vs))
    for (double u : inside(us)) {
      const nurbs::SurfaceJet jet = nurbs::evaluate_jet(patch, u, v);
      if (jet.du.cross(jet.dv).dot(normal) <= 0.0) return true;
    }
  return false;
}

Vec3 area_vector(const nurbs::Curve& closed) {
  const std::vector<double> breaks = nurbs::breakpoints(closed.knots, closed.degree);
  // A polynomial's C x C' has degree 2 p - 2 at most; a rational one is approximated, down to rounding in
  // four parts.
  const nurbs::GaussRule& rule = nurbs::gauss_rule(closed.is_rational() ? 8 : closed.degree);
  const int parts = closed.is_rational() ? 4 : 1;
  const Vec3 origin = closed.points.front();
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
    for (int part = 0; part < parts; ++part) {
      const double half = 0.5 * (breaks[k + 1] - breaks[k]) / parts,
                   middle = breaks[k] + half * (2 * part + 1);
      for (std::size_t g = 0; g < rule.nodes.size(); ++g) {
        const nurbs::CurveJet jet = nurbs::evaluate_jet(closed, middle + half * rule.nodes[g]);
        sum += 0.5 * half * rule.weights[g] * (jet.position - origin).cross(jet.d1);
      }
    }
  return sum;
}

double flatness(const nurbs::Curve& curve, const Vec3& origin, const Vec3& normal) {
  double largest = 0.0;
  for (const Vec3& p : curve.points) largest = std::max(largest, std::abs((p - origin).dot(normal)));
  return largest;
}

double last_digit(std::span<const Vec3> points) {
  int decimals = std::numeric_limits<int>::min();
  for (const Vec3& p : points)
    for (const double value : p) {
      // "12.345", "1e-07", "1.5e+20"
      const std::string text = number_text(value);
      const std::size_t power = std::min(text.find('e'), text.size()), point = text.find('.');
      const int shift = power < text.size() ? std::stoi(text.substr(power + 1)) : 0;
      const int behind = point < power ? static_cast<int>(power - point) - 1 : 0;
      if (value != 0.0) decimals = std::max(decimals, behind - shift);
    }
  return points.empty() ? 0.0 : std::pow(10.0, -decimals);
}

namespace {

Message at_end(const Body& body, bool last, const Message& message) {
  return message.of_yarn(body.name, body.place).at_point((last ? body.end : body.start).origin);
}

// The centre of the end: of the section's outline.
Vec3 end_centre(const Body& body, const nurbs::Curve& outline, bool last) {
  if (!body.axis.points.empty()) return last ? body.axis.points.back() : body.axis.points.front();
  return mean_of(std::span(outline.points).first(outline.points.size() - 1));
}

bool has_same_points(const nurbs::Surface& a, const nurbs::Surface& b) {
  if (a.count_u != b.count_u || a.count_v != b.count_v || a.degree_u != b.degree_u ||
      a.degree_v != b.degree_v || a.knots_u != b.knots_u || a.knots_v != b.knots_v || a.points != b.points)
    return false;
  for (int j = 0; j < a.count_v; ++j)
    for (int i = 0; i < a.count_u; ++i)
      if (a.weight(i, j) != b.weight(i, j)) return false;
  return true;
}

Vec3 centre_of_fan(const nurbs::Surface& fan) {
  return fan.point(0, fan.count_v - 1);
}

// The surface of a patch or fan that seals this end of the body.
nurbs::Surface standard_surface(const Body& body, bool last) {
  const EndFace& face = last ? body.end : body.start;
  if (face.style == EndStyle::patch) return coons_patch(end_quarters(body, last));
  return fan(end_curve(body, last), centre_of_fan(face.surface));
}

double flat_enough_for(const nurbs::Curve& outline, const EndFace& face) {
  double size = 0.0;
  for (const Vec3& p : outline.points) size = std::max(size, (p - face.origin).norm());
  return flat_enough(size, face.origin.cwiseAbs().maxCoeff());
}

// Moves the points of this end into its plane.
Status flatten_end(Body& body, bool last, double unflat) {
  const EndFace& face = last ? body.end : body.start;
  const Vec3 origin = face.origin, normal = face.normal;
  const auto flatten = [&](Vec3& p) { p -= (p - origin).dot(normal) * normal; };
  nurbs::Surface& surface = body.surface;
  const auto round = static_cast<std::size_t>(surface.count_u);
  const std::size_t first = last ? surface.points.size() - round : 0;
  for (Vec3& p : std::span(surface.points).subspan(first, round)) flatten(p);
  if (!body.axis.points.empty()) flatten(last ? body.axis.points.back() : body.axis.points.front());
  Message note = warning(Kind::geometry, fmt::format("the {} of yarn '{}' is brought into its plane, {:.3g} "
                                                     "away at most: its numbers say no more",
                                                     last ? "end" : "start", body.name, unflat));
  note.severity = Severity::note;
  body.messages.push_back(at_end(body, last, note));
  return complete_end(body, last);
}

Status seal_end(Body& body, bool last, const Sealing& sealing) {
  EndFace& face = last ? body.end : body.start;
  const nurbs::Curve outline = end_curve(body, last);
  const EndStyle style = sealing.style;
  face.style = style;
  if (style == EndStyle::patch) face.surface = coons_patch(end_quarters(body, last));
  if (style == EndStyle::fan)
    face.surface = fan(outline, sealing.centre.value_or(end_centre(body, outline, last)));
  if (Status completed = complete_end(body, last); !completed) return completed;
  const double unflat = flatness(outline, face.origin, face.normal);
  const bool is_flat = unflat <= flat_enough_for(outline, face);
  const bool can_be_planar = is_flat || unflat <= sealing.resolution;
  // The patch runs round as the outline does, so its normal is the outline's turning direction.
  if (style == EndStyle::patch && is_folded(face.surface, area_vector(outline).normalized())) {
    if (!can_be_planar)
      return at_end(
          body, last,
          error(Kind::geometry,
                fmt::format("the patch that shall seal the {} of yarn '{}' folds over itself, and the end is "
                            "not flat (by {:.3g}), so that no plane can seal it either; use --ends fan",
                            last ? "end" : "start", body.name, unflat)));
    face.style = EndStyle::planar;
    face.surface = {};
    face.inward = false;
    body.messages.push_back(
        at_end(body, last,
               warning(Kind::geometry, fmt::format("the patch that shall seal the {} of yarn '{}' would fold "
                                                   "over itself (the section is too long or concave): it is "
                                                   "sealed by a trimmed plane instead",
                                                   last ? "end" : "start", body.name))));
  }
  if (face.style != EndStyle::planar || is_flat) return {};
  if (can_be_planar) return flatten_end(body, last, unflat);
  return at_end(body, last,
                error(Kind::geometry,
                      fmt::format("the {} of yarn '{}' is not flat (by {:.3g}): a plane cannot seal it; use "
                                  "--ends patch, or a `tolerance` that is larger than that",
                                  last ? "end" : "start", body.name, unflat)));
}

}  // namespace

Status complete_end(Body& body, bool last) {
  EndFace& face = last ? body.end : body.start;
  const nurbs::Curve outline = end_curve(body, last);
  face.origin = face.style == EndStyle::fan ? centre_of_fan(face.surface) : end_centre(body, outline, last);
  // Round the section the outline turns about the path (against it when the body's normals point inward); out
  // of the yarn is against the path at the start.
  const Vec3 turning = area_vector(outline);
  const double sign = (last != body.inward) ? 1.0 : -1.0;
  if (turning.norm() == 0.0)
    return at_end(body, last,
                  error(Kind::geometry, fmt::format("the {} section of yarn '{}' has no area",
                                                    last ? "last" : "first", body.name)));
  face.normal = sign * turning.normalized();
  // The outline stands on a grid that the path knows nothing of: the plane is the outline's.
  if (face.style != EndStyle::fan) {
    const Vec3 middle = mean_of(std::span(outline.points).first(outline.points.size() - 1));
    face.origin += (middle - face.origin).dot(face.normal) * face.normal;
  }
  if (face.style == EndStyle::patch) face.inward = face.normal.dot(turning) < 0.0;
  // v runs from the rim to the centre: the normal is on the side about which the rim turns. One point does
  // not show it: at a section's cusp both derivatives have the same direction.
  if (face.style == EndStyle::fan)
    face.inward = area_vector(nurbs::boundary_row(face.surface, false)).dot(face.normal) < 0.0;
  return {};
}

bool is_standard_end(const Body& body, bool last) {
  const EndFace& face = last ? body.end : body.start;
  if (face.style != EndStyle::patch && face.style != EndStyle::fan) return true;
  return has_same_points(face.surface, standard_surface(body, last));
}

void renew_end(Body& body, bool last) {
  EndFace& face = last ? body.end : body.start;
  if (face.style == EndStyle::patch || face.style == EndStyle::fan)
    face.surface = standard_surface(body, last);
}

Status seal(Body& body, const Sealings& sealings) {
  body.start = body.end = EndFace{};
  if (body.closed_along) return {};
  for (const bool last : {false, true}) {
    const Sealing& sealing = sealings[last ? 1 : 0];
    if (sealing.style == EndStyle::none) continue;
    Status status = seal_end(body, last, sealing);
    if (!status) return status;
  }
  return {};
}

Sealings both_ends(EndStyle style) {
  return {Sealing{style, {}}, Sealing{style, {}}};
}

Status seal(Body& body, EndStyle style) {
  return seal(body, both_ends(style));
}

}  // namespace selvage::yarn
