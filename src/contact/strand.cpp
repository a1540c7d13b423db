#include "contact/strand.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/index.h"
#include "nurbs/basis.h"
#include "nurbs/divided.h"
#include "nurbs/restrict.h"
#include "yarn/grid.h"

namespace selvage::contact {

namespace {

// psi = x^i y^j of each field.
constexpr std::array<std::array<int, 2>, shape_modes> powers = {
    {{2, 0}, {1, 1}, {0, 2}, {3, 0}, {2, 1}, {1, 2}, {0, 3}, {4, 0}, {3, 1}, {2, 2}, {1, 3}, {0, 4}}};

// Uniform cubic B-splines at the share t of a span.
void cubic(double t, double step, Stencil& out) {
  const double s = 1.0 - t;
  out.value = {s * s * s / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
               (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0, t * t * t / 6.0};
  out.slope = {-0.5 * s * s / step, (1.5 * t * t - 2.0 * t) / step, -(1.5 * s * s - 2.0 * s) / step,
               0.5 * t * t / step};
  out.bend = {s / (step * step), (3.0 * t - 2.0) / (step * step), (3.0 * s - 2.0) / (step * step),
              t / (step * step)};
}

constexpr int chords_a_span = 8;

// Of the centre line at each of these parameters, from the first one.
std::vector<double> arcs_at(const nurbs::Curve& centres, const std::vector<double>& parameters) {
  std::vector<double> arcs = {0.0};
  Vec3 last = nurbs::evaluate(centres, parameters.front());
  for (std::size_t k = 1; k < parameters.size(); ++k) {
    const Vec3 p = nurbs::evaluate(centres, parameters[k]);
    arcs.push_back(arcs.back() + (p - last).norm());
    last = p;
  }
  return arcs;
}

// Knots that bring neighbouring rows nearer than `spacing`, by the length of the centre line over each span.
std::vector<double> missing_knots(const nurbs::Curve& centres, double spacing) {
  const std::vector<double> breaks = nurbs::breakpoints(centres.knots, centres.degree);
  const std::vector<double> arcs =
      arcs_at(centres, nurbs::divided(centres.knots, centres.degree, chords_a_span));
  std::vector<int> parts;
  for (std::size_t k = chords_a_span; k < arcs.size(); k += chords_a_span)
    parts.push_back(
        std::max(1, static_cast<int>(std::ceil((arcs[k] - arcs[k - chords_a_span]) / spacing - 1e-9))));
  const std::vector<double> all = nurbs::divided(breaks, parts);
  std::vector<double> knots;
  std::set_difference(all.begin(), all.end(), breaks.begin(), breaks.end(), std::back_inserter(knots));
  return knots;
}

// Where a value stands in an increasing table: between entries `above` - 1 and `above`, by a share.
struct TablePlace {
  std::size_t above;
  double share;
  [[nodiscard]] double in(const std::vector<double>& other) const {
    return other[above - 1] + share * (other[above] - other[above - 1]);
  }
};
TablePlace place_in(const std::vector<double>& table, double value) {
  const auto next = std::upper_bound(table.begin() + 1, table.end() - 1, value);
  const double low = *(next - 1), step = *next - low;
  return {static_cast<std::size_t>(next - table.begin()),
          step > 0.0 ? std::clamp((value - low) / step, 0.0, 1.0) : 0.0};
}

}  // namespace

int field_degree(int mode) {
  return powers[at(mode)][0] + powers[at(mode)][1] - 1;
}

std::array<Vec2, shape_modes> shape_fields(const Frame& frame, const Vec2& local) {
  const double x = local.x() / frame.half_x, y = local.y() / frame.half_y;
  const std::array<double, 5> px = {1.0, x, x * x, x * x * x, x * x * x * x};
  const std::array<double, 5> py = {1.0, y, y * y, y * y * y, y * y * y * y};
  std::array<Vec2, shape_modes> fields;
  for (std::size_t m = 0; m < fields.size(); ++m) {
    const int i = powers[m][0], j = powers[m][1];
    const double scale = 1.0 / std::hypot(i / frame.half_x, j / frame.half_y);
    fields[m] = Vec2(j == 0 ? 0.0 : j * px[at(i)] * py[at(j - 1)] / frame.half_y,
                     i == 0 ? 0.0 : -i * px[at(i - 1)] * py[at(j)] / frame.half_x) *
                scale;
  }
  return fields;
}

void displacement_form(const Frame& frame, const Stencil& stencil, const Vec3& point, const Vec3& direction,
                       int modes, int fields, Form& form) {
  const Vec3 offset = point - frame.centre;
  const double tilt = frame.tilts ? frame.along.dot(direction) : 0.0;
  // An end stays in its plane.
  const Vec3 way = frame.tilts ? direction : Vec3(direction - frame.along.dot(direction) * frame.along);
  std::array<double, shape_modes> shapes{};
  if (modes == all_modes && fields > 0) {
    const std::array<Vec2, shape_modes> known =
        shape_fields(frame, {offset.dot(frame.x), offset.dot(frame.y)});
    const Vec2 plane(direction.dot(frame.x), direction.dot(frame.y));
    for (std::size_t m = 0; m < at(fields); ++m) shapes[m] = known[m].dot(plane);
  }
  for (int k = 0; k < 4; ++k) {
    const Vec3 translation = stencil.value[at(k)] * way - tilt * stencil.slope[at(k)] * offset;
    for (int c = 0; c < 3; ++c) form[k * modes + c] = translation[c];
    for (int m = translation_modes; m < modes; ++m)
      form[k * modes + m] = stencil.value[at(k)] * shapes[at(m - translation_modes)];
  }
}

void Strand::set_lattice(double spacing, double origin, int nodes, bool cyclic) {
  spacing_ = spacing;
  origin_ = origin;
  nodes_ = nodes;
  cyclic_ = cyclic;
  row_stencils_.clear();
  for (double arc : row_arcs_) row_stencils_.push_back(stencil(arc));
}

Vec3 Strand::centre_at(double arc) const {
  return nurbs::evaluate(centres_, parameter_at(arc));
}

Strand::Strand(yarn::Body body, double spacing) : body_(std::move(body)), cyclic_(body_.closed_along) {
  const std::vector<double> knots = missing_knots(yarn::section_centres(body_.surface), spacing);
  if (!knots.empty()) body_.surface = nurbs::refined(body_.surface, knots);
  centres_ = yarn::section_centres(body_.surface);
  table_v_ = nurbs::divided(centres_.knots, centres_.degree, chords_a_span);
  table_arc_ = arcs_at(centres_, table_v_);
  length_ = table_arc_.back();
  const int spans = std::max(cyclic_ ? 4 : 1, static_cast<int>(std::lround(length_ / spacing)));
  const std::vector<double> places =
      nurbs::greville(body_.surface.knots_v, body_.surface.degree_v, body_.surface.count_v);
  for (double v : places) row_arcs_.push_back(arc_of(v));
  set_lattice(length_ / spans, 0.0, cyclic_ ? spans : spans + 3, cyclic_);
  row_frames_.resize(row_arcs_.size());
  measure();
  for (int j = 0; j < rows(); ++j) row_areas_.push_back(row_area(j));
  thickness_ = yarn::narrowest_section(body_);
  for (const Frame& frame : row_frames_)
    width_ = std::max(width_, 2.0 * std::max(frame.half_x, frame.half_y));
}

Stencil Strand::stencil(double arc) const {
  Stencil out;
  double place = (arc + origin_) / spacing_;
  const int spans = cyclic_ ? nodes_ : nodes_ - 3;
  if (cyclic_) place -= spans * std::floor(place / spans);
  out.first = std::clamp(static_cast<int>(std::floor(place)), 0, spans - 1);
  cubic(place - out.first, spacing_, out);
  return out;
}

double Strand::arc_of(double v) const {
  return place_in(table_v_, v).in(table_arc_);
}

double Strand::parameter_at(double arc) const {
  return place_in(table_arc_, arc).in(table_v_);
}

Frame Strand::frame_at(double v) const {
  const nurbs::CurveJet jet = nurbs::evaluate_jet(centres_, v);
  Frame frame;
  frame.centre = jet.position;
  frame.along = jet.d1.normalized();
  const Vec3 seam = nurbs::evaluate(body_.surface, body_.surface.first_u(), v) - frame.centre;
  frame.x = (seam - seam.dot(frame.along) * frame.along).normalized();
  frame.y = frame.along.cross(frame.x);
  // Half extents change slowly: those of the nearest rows.
  const auto [k, share] = place_in(row_arcs_, arc_of(v));
  frame.half_x = (1.0 - share) * row_frames_[k - 1].half_x + share * row_frames_[k].half_x;
  frame.half_y = (1.0 - share) * row_frames_[k - 1].half_y + share * row_frames_[k].half_y;
  frame.tilts = is_cyclic() || (v > body_.surface.first_v() && v < body_.surface.last_v());
  return frame;
}

void Strand::measure() {
  const nurbs::Surface& s = body_.surface;
  centres_ = yarn::section_centres(s);
  const std::vector<double> places = nurbs::greville(s.knots_v, s.degree_v, s.count_v);
  for (int j = 0; j < s.count_v; ++j) {
    Frame& frame = row_frames_[at(j)];
    frame.centre = centres_.points[at(j)];
    const bool is_end = !is_cyclic() && (j == 0 || j == s.count_v - 1);
    frame.tilts = !is_end;
    if (is_end) {
      frame.along = Vec3::Zero();
      for (int i = 0; i + 1 < s.count_u; ++i)
        frame.along += (s.point(i, j) - frame.centre).cross(s.point(i + 1, j) - frame.centre);
      frame.along.normalize();
      if (frame.along.dot(nurbs::evaluate_jet(centres_, places[at(j)]).d1) < 0.0) frame.along = -frame.along;
    } else {
      frame.along = nurbs::evaluate_jet(centres_, places[at(j)]).d1.normalized();
    }
    const Vec3 seam = s.point(0, j) - frame.centre;
    frame.x = (seam - seam.dot(frame.along) * frame.along).normalized();
    frame.y = frame.along.cross(frame.x);
    frame.half_x = frame.half_y = 0.0;
    for (int i = 0; i < s.count_u; ++i) {
      const Vec3 offset = s.point(i, j) - frame.centre;
      frame.half_x = std::max(frame.half_x, std::abs(offset.dot(frame.x)));
      frame.half_y = std::max(frame.half_y, std::abs(offset.dot(frame.y)));
    }
  }
}

double Strand::row_area(int j) const {
  const nurbs::Surface& s = body_.surface;
  const Frame& frame = row_frames_[at(j)];
  double twice = 0.0;
  for (int i = 0; i + 1 < s.count_u; ++i) {
    const Vec3 p = s.point(i, j) - frame.centre, q = s.point(i + 1, j) - frame.centre;
    twice += p.cross(q).dot(frame.along);
  }
  return std::abs(0.5 * twice);
}

void Strand::restore_areas() {
  nurbs::Surface& s = body_.surface;
  for (int j = 0; j < s.count_v; ++j) {
    const double factor = std::sqrt(row_areas_[at(j)] / row_area(j));
    const Frame& frame = row_frames_[at(j)];
    for (int i = 0; i < s.count_u; ++i) {
      const Vec3 offset = s.point(i, j) - frame.centre;
      const Vec3 across = offset - offset.dot(frame.along) * frame.along;
      s.point(i, j) += (factor - 1.0) * across;
    }
  }
}

void Strand::move(const Eigen::Ref<const Eigen::VectorXd>& coefficients, int modes, double factor) {
  nurbs::Surface& s = body_.surface;
  for (int j = 0; j < s.count_v; ++j) {
    const Stencil& stencil = row_stencils_[at(j)];
    const Frame frame = row_frames_[at(j)];
    Vec3 translation = Vec3::Zero(), slope = Vec3::Zero();
    std::array<double, shape_modes> shapes{};
    for (int k = 0; k < 4; ++k) {
      const auto node = static_cast<Eigen::Index>((stencil.first + k) % nodes_) * modes;
      const Vec3 t = coefficients.segment<3>(node);
      translation += factor * stencil.value[at(k)] * t;
      slope += factor * stencil.slope[at(k)] * t;
      for (int m = translation_modes; m < modes; ++m)
        shapes[at(m - translation_modes)] += factor * stencil.value[at(k)] * coefficients[node + m];
    }
    if (!frame.tilts) {
      translation -= translation.dot(frame.along) * frame.along;
      slope.setZero();
    }
    for (int i = 0; i < s.count_u; ++i) {
      Vec3& p = s.point(i, j);
      const Vec3 offset = p - frame.centre;
      Vec3 shift = translation - offset.dot(slope) * frame.along;
      if (modes == all_modes) {
        const std::array<Vec2, shape_modes> fields =
            shape_fields(frame, {offset.dot(frame.x), offset.dot(frame.y)});
        for (std::size_t m = 0; m < fields.size(); ++m)
          shift += shapes[m] * (fields[m].x() * frame.x + fields[m].y() * frame.y);
      }
      p += shift;
    }
    s.point(s.count_u - 1, j) = s.point(0, j);
  }
  measure();
  restore_areas();
  if (is_cyclic())
    for (int i = 0; i < s.count_u; ++i) s.point(i, s.count_v - 1) = s.point(i, 0);
  measure();
}

double Strand::largest_move(const Eigen::Ref<const Eigen::VectorXd>& coefficients, int modes) const {
  double largest = 0.0;
  for (const Stencil& stencil : row_stencils_) {
    Vec3 translation = Vec3::Zero();
    double shape = 0.0;
    for (int k = 0; k < 4; ++k) {
      const auto node = static_cast<Eigen::Index>((stencil.first + k) % nodes_) * modes;
      translation += stencil.value[at(k)] * coefficients.segment<3>(node);
      for (int m = translation_modes; m < modes; ++m)
        shape = std::max(shape, std::abs(coefficients[node + m]));
    }
    largest = std::max(largest, translation.norm() + shape);
  }
  return largest;
}

}  // namespace selvage::contact
