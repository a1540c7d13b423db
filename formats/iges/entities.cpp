#include "formats/iges/entities.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "nurbs/turn.h"

namespace selvage::formats::iges {

namespace {

// Weights that are all the same do not make a surface rational.
bool is_polynomial(const std::vector<double>& weights) {
  return std::all_of(weights.begin(), weights.end(),
                     [&weights](double weight) { return weight == weights.front(); });
}

void write_weights(Records& records, const std::vector<double>& weights, std::size_t count) {
  if (weights.empty())
    records.ones(count);
  else
    records.reals(weights);
}

bool is_closed(const nurbs::Curve& curve) {
  return nurbs::is_clamped(curve.knots, curve.degree) && curve.points.front() == curve.points.back() &&
         (curve.weights.empty() || curve.weights.front() == curve.weights.back());
}

// Does the first control column (row) equal the last, in a surface that is clamped there?
bool is_closed(const nurbs::Surface& surface, bool in_u) {
  if (!(in_u ? nurbs::is_clamped(surface.knots_u, surface.degree_u)
             : nurbs::is_clamped(surface.knots_v, surface.degree_v)))
    return false;
  const nurbs::Curve first =
                         in_u ? nurbs::boundary_column(surface, false) : nurbs::boundary_row(surface, false),
                     last = in_u ? nurbs::boundary_column(surface, true) : nurbs::boundary_row(surface, true);
  return first.points == last.points && first.weights == last.weights;
}

}  // namespace

// Magnitudes order like their bits, and what is not finite is above all others.
std::optional<double> largest_of(std::span<const double> values) {
  constexpr std::uint64_t sign = std::uint64_t{1} << 63U;
  std::uint64_t largest = 0;
  for (const double value : values) largest = std::max(largest, std::bit_cast<std::uint64_t>(value) & ~sign);
  const double magnitude = std::bit_cast<double>(largest);
  return std::isfinite(magnitude) ? std::optional(magnitude) : std::nullopt;
}

std::optional<double> largest_of(const std::vector<Vec3>& points) {
  return points.empty() ? 0.0 : largest_of({points.data()->data(), 3 * points.size()});
}

bool is_finite(const nurbs::Surface& surface) {
  return largest_of(surface.points) && largest_of(surface.weights) && largest_of(surface.knots_u) &&
         largest_of(surface.knots_v);
}

bool is_finite(const nurbs::Curve& curve) {
  return largest_of(curve.points) && largest_of(curve.weights) && largest_of(curve.knots);
}

int write_surface(Records& records, const Entity& entity, const nurbs::Surface& surface, int property) {
  const int pointer = records.begin(entity);
  records.integer(surface.count_u - 1);
  records.integer(surface.count_v - 1);
  records.integer(surface.degree_u);
  records.integer(surface.degree_v);
  records.integer(is_closed(surface, true) ? 1 : 0);
  records.integer(is_closed(surface, false) ? 1 : 0);
  records.integer(is_polynomial(surface.weights) ? 1 : 0);
  records.integer(0);  // periodic in neither direction: the knots are clamped
  records.integer(0);
  records.reals(surface.knots_u);
  records.reals(surface.knots_v);
  write_weights(records, surface.weights, surface.points.size());
  records.points(surface.points);
  records.real(surface.first_u());
  records.real(surface.last_u());
  records.real(surface.first_v());
  records.real(surface.last_v());
  records.end(property);
  return pointer;
}

int write_curve(Records& records, const Entity& entity, const nurbs::Curve& curve, const Vec3* normal,
                int property) {
  const int pointer = records.begin(entity);
  records.integer(static_cast<std::int64_t>(curve.points.size()) - 1);
  records.integer(curve.degree);
  records.integer(normal != nullptr ? 1 : 0);
  records.integer(is_closed(curve) ? 1 : 0);
  records.integer(is_polynomial(curve.weights) ? 1 : 0);
  records.integer(0);
  records.reals(curve.knots);
  write_weights(records, curve.weights, curve.points.size());
  records.points(curve.points);
  records.real(curve.first_parameter());
  records.real(curve.last_parameter());
  const Vec3 direction = normal != nullptr ? *normal : Vec3::Zero();
  records.reals(direction.data(), 3);
  records.end(property);
  return pointer;
}

int write_planar_end(Records& records, const Common& common, const yarn::Body& body, bool last) {
  const nurbs::Curve outline = yarn::end_curve(body, last);
  const yarn::EndPlane plane = yarn::end_plane(body, outline, last);
  const Vec3 up = Vec3::UnitZ();
  const int surface = write_surface(records, common.entity(128, 0, dependent), plane.surface);
  const int flat =
      write_curve(records, common.entity(126, 0, dependent_in_2d), plane.in_parameters(outline), &up);
  const int curve = write_curve(records, common.entity(126, 0, dependent), outline, &plane.normal);
  const int boundary = write_boundary(records, common, surface, flat, curve);
  return write_trimmed(records, common, {&boundary, 1}, surface);
}

int write_boundary(Records& records, const Common& common, int surface, int flat, int spatial,
                   bool flat_is_true) {
  const int pointer = records.begin(common.entity(142, 0, dependent));
  records.integer(0);  // how the curve was made: not said
  records.integer(surface);
  records.integer(flat);
  records.integer(spatial);
  records.integer(flat_is_true ? 1 : 2);  // which is the true one
  records.end();
  return pointer;
}

int write_trimmed(Records& records, const Common& common, std::span<const int> boundaries, int surface) {
  const int pointer = records.begin(common.entity(144));
  records.integer(surface);
  records.integer(1);  // the outer boundary is not the surface's own
  records.integer(static_cast<std::int64_t>(boundaries.size()) - 1);
  for (const int boundary : boundaries) records.integer(boundary);
  records.end(common.name);
  return pointer;
}

int write_composite(Records& records, const Common& common, std::string_view status,
                    std::span<const int> curves) {
  const int pointer = records.begin(common.entity(102, 0, status));
  records.list(curves);
  records.end();
  return pointer;
}

int write_group(Records& records, const Common& common, std::span<const int> members) {
  const int pointer = records.begin(common.entity(402, 7));
  records.list(members);
  records.end(common.name);
  return pointer;
}

int write_name(Records& records, const Common& common) {
  const int pointer = records.begin({.type = 406, .form = 15, .label = common.label});
  records.integer(1);  // number of values
  records.text(common.label);
  records.end();
  return pointer;
}

int write_level_name(Records& records, int level, std::string_view name) {
  const int pointer = records.begin({.type = 406, .form = 3, .level = level, .label = name});
  records.integer(2);  // number of values
  records.integer(0);  // function code: none
  records.text(name);
  records.end();
  return pointer;
}

int write_definition(Records& records, const Common& common, std::string_view ascii_name,
                     std::span<const int> members) {
  const int pointer = records.begin(common.entity(308, 0, definition));
  records.integer(0);  // depth: no instances inside
  records.text(ascii_name);
  records.list(members);
  records.end();
  return pointer;
}

int write_instance(Records& records, const Common& common, int definition_pointer,
                   const yarn::RigidMotion& motion) {
  Entity entity = common.entity(408);
  if (!motion.is_translation()) {
    entity.matrix = records.begin({.type = 124, .label = common.label});
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) records.real(motion.rotation(row, column));
      records.real(motion.offset[row]);
    }
    records.end();
  }
  const Vec3 shift = motion.is_translation() ? motion.offset : Vec3::Zero();
  const int pointer = records.begin(entity);
  records.integer(definition_pointer);
  records.reals(shift.data(), 3);
  records.real(1);  // scale
  records.end(common.name);
  return pointer;
}

int write_color(Records& records, const yarn::Color& color) {
  const int pointer = records.begin({.type = 314, .status = definition, .label = {}});
  for (const int part : {color.red, color.green, color.blue}) records.real(part * 100.0 / 255.0);  // percent
  records.end();
  return pointer;
}

}  // namespace selvage::formats::iges
