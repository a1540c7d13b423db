#include "formats/iges/entities.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

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

}  // namespace

bool is_closed_u(const nurbs::Surface& surface) {
  if (!nurbs::is_clamped(surface.knots_u, surface.degree_u)) return false;
  const int last = surface.count_u - 1;
  for (int j = 0; j < surface.count_v; ++j)
    if (surface.point(0, j) != surface.point(last, j) || surface.weight(0, j) != surface.weight(last, j))
      return false;
  return true;
}

bool is_closed_v(const nurbs::Surface& surface) {
  if (!nurbs::is_clamped(surface.knots_v, surface.degree_v)) return false;
  const int last = surface.count_v - 1;
  for (int i = 0; i < surface.count_u; ++i)
    if (surface.point(i, 0) != surface.point(i, last) || surface.weight(i, 0) != surface.weight(i, last))
      return false;
  return true;
}

bool is_closed(const nurbs::Curve& curve) {
  return nurbs::is_clamped(curve.knots, curve.degree) && curve.points.front() == curve.points.back() &&
         (curve.weights.empty() || curve.weights.front() == curve.weights.back());
}

int write_surface(Records& records, const Entity& entity, const nurbs::Surface& surface, int property) {
  const int pointer = records.begin(entity);
  records.integer(surface.count_u - 1);
  records.integer(surface.count_v - 1);
  records.integer(surface.degree_u);
  records.integer(surface.degree_v);
  records.integer(is_closed_u(surface) ? 1 : 0);
  records.integer(is_closed_v(surface) ? 1 : 0);
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
  return write_trimmed(records, common, write_boundary(records, common, surface, flat, curve), surface);
}

int write_boundary(Records& records, const Common& common, int surface, int flat, int spatial) {
  const int pointer = records.begin(common.entity(142, 0, dependent));
  records.integer(0);  // how the curve was made: not said
  records.integer(surface);
  records.integer(flat);
  records.integer(spatial);
  records.integer(2);  // the curve in space is the true one
  records.end();
  return pointer;
}

int write_trimmed(Records& records, const Common& common, int boundary, int surface) {
  const int pointer = records.begin(common.entity(144));
  records.integer(surface);
  records.integer(1);  // the outer boundary is not the surface's own
  records.integer(0);  // no holes
  records.integer(boundary);
  records.end(common.name);
  return pointer;
}

int write_group(Records& records, const Common& common, std::span<const int> members) {
  const int pointer = records.begin(common.entity(402, 7));
  records.integer(static_cast<std::int64_t>(members.size()));
  for (const int member : members) records.integer(member);
  records.end(common.name);
  return pointer;
}

int write_name(Records& records, const Common& common, std::string_view ascii_name) {
  const int pointer = records.begin({.type = 406, .form = 15, .label = common.label});
  records.integer(1);  // number of values
  records.text(ascii_name);
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
  records.integer(static_cast<std::int64_t>(members.size()));
  for (const int member : members) records.integer(member);
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
