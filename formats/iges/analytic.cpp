// 108, 190, 192, 194, 196, 198: planes and round surfaces by formula.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "cad/natural_border.h"
#include "formats/iges/curves.h"
#include "formats/iges/surfaces.h"
#include "formats/iges/types.h"

namespace selvage::formats::iges {

namespace {

using Kind = nurbs::Analytic::Kind;

// The vector of a 116 or 123, turned as its own transformation says, and for a point moved.
std::optional<Vec3> pointed_vector(Reading& reading, int pointer, int type, Parameters& by) {
  const DirectoryEntry* const entry = reading.entry(pointer, type, by);
  const std::optional<Vec3> vector = reading.inside(entry, by, [&](Parameters& in) {
    const Vec3 read = read_point(in);
    if (in.ok() && type == 123 && !(read.norm() > 0)) in.fail("a direction without length");
    return std::optional(read);
  });
  if (!vector) return std::nullopt;
  const Placement placement = reading.placement(*entry);
  if (type == 116) return placement(*vector);
  return placement.is_identity ? vector : std::optional<Vec3>(placement.linear * *vector);
}

// A x + B y + C z = D.
std::optional<nurbs::Analytic> read_plane(Parameters& in) {
  const Vec3 normal = read_point(in);
  const double distance = in.real();
  if (in.ok() && !(normal.norm() > 0)) in.fail("a plane without a normal");
  if (!in.ok()) return std::nullopt;
  return nurbs::Analytic::placed(Kind::plane, distance / normal.squaredNorm() * normal, normal, Vec3::Zero());
}

double read_radius(Parameters& in, const char* what) {
  const double radius = in.real();
  if (in.ok() && !(radius > 0)) in.fail(fmt::format("a {} of {}", what, radius));
  return radius;
}

// 108: form 1 is bounded by a curve.
std::optional<cad::Face> read_bounded_plane(Reading& reading, const DirectoryEntry& entry, Parameters& in) {
  std::optional<nurbs::Analytic> plane = read_plane(in);
  const int pointer = in.pointer();
  for (int value = 0; value < 4; ++value) in.real();  // where its symbol stands, and how large
  if (!plane) return std::nullopt;
  if (entry.form != 1 || pointer == 0)
    return in.give_up(entry.form == -1 ? "it is a hole in a plane" : "it is a plane without end");
  std::vector<nurbs::Curve> chain = read_chain(reading, pointer, in);
  if (!in.ok()) return std::nullopt;
  cad::Loop loop;
  for (nurbs::Curve& curve : chain) loop.edges.push_back({std::move(curve), {}, -1});
  const auto range = plane->bounded_by({points_along(loop)});
  if (!range) return in.fail("its curve bounds no area");
  cad::Face face;
  face.surface = plane->part(plane->widened(*range));
  face.loops.push_back(std::move(loop));
  return face;
}

bool is_simple_form(int form) {
  return form == 0 || form == 1;
}

constexpr int deepest_offset = 8;  // of offsets of offsets

bool is_formula(const DirectoryEntry& entry) {
  return entry.type == 108 || (entry.type >= 190 && entry.type <= 198 && entry.type % 2 == 0);
}

// A 140 of one of these: in the middle of its parameters its side is told.
std::optional<nurbs::Analytic> read_at_distance(Reading& reading, Parameters& in) {
  const std::optional<OffsetOf> offset = read_offset(in);
  const DirectoryEntry* const entry = offset ? reading.entry(offset->base, in) : nullptr;
  if (entry == nullptr) return std::nullopt;
  reading.use(offset->base);
  std::optional<nurbs::Analytic> base =
      reading.inside(entry, in, [&](Parameters& of_base) { return read_analytic(reading, *entry, of_base); });
  if (!base) return std::nullopt;
  const Placement placement = reading.placement(*entry);
  if (!placement.is_identity) {
    base->origin = placement(base->origin);
    for (Vec3* const axis : {&base->x, &base->y, &base->z}) *axis = (placement.linear * *axis).normalized();
  }
  using std::numbers::pi;
  const Vec3 normal = base->normal(pi, base->kind == Kind::torus ? pi : 0);
  std::optional<nurbs::Analytic> moved =
      base->at_distance(offset->side.dot(normal) < 0 ? -offset->distance : offset->distance);
  if (!moved) return in.give_up("nothing is left of its surface at that distance");
  return moved;
}

}  // namespace

bool is_analytic(Reading& reading, const DirectoryEntry& entry) {
  const DirectoryEntry* shape = &entry;
  for (int depth = 0; shape != nullptr && shape->type == 140 && depth < deepest_offset; ++depth) {
    Parameters in = reading.file().parameters(*shape);
    const std::optional<OffsetOf> offset = read_offset(in);
    shape = offset ? reading.file().entity(offset->base) : nullptr;
  }
  return shape != nullptr && is_formula(*shape);
}

// Form 1 has a direction at which angles begin; a sphere's axis, too, is given only there.
std::optional<nurbs::Analytic> read_analytic(Reading& reading, const DirectoryEntry& entry, Parameters& in) {
  if (entry.type == 140) return read_at_distance(reading, in);
  if (entry.type == 108) return read_plane(in);
  const int place = in.pointer();
  const bool is_sphere = entry.type == 196, has_reference = entry.form == 1;
  double radius = 0, second = 0;
  if (is_sphere) radius = read_radius(in, "radius");
  const int axis_pointer = !is_sphere || has_reference ? in.pointer() : 0;
  if (entry.type == 192) radius = read_radius(in, "radius");
  if (entry.type == 194) {
    radius = in.real();
    second = in.real();
    if (in.ok() && !(radius >= 0)) in.fail(fmt::format("a radius of {}", radius));
    if (in.ok() && !(second > 0 && second < 90))
      in.fail(fmt::format("a cone's half angle of {} degrees", second));
  }
  if (entry.type == 198) {
    radius = read_radius(in, "major radius");
    second = read_radius(in, "minor radius");
    if (in.ok() && second >= radius)
      in.give_up(fmt::format("its radii are {} and {}: it crosses itself", radius, second));
  }
  const int reference_pointer = has_reference ? in.pointer() : 0;
  if (!in.ok()) return std::nullopt;
  const std::optional<Vec3> origin = pointed_vector(reading, place, 116, in);
  Vec3 axis = Vec3::UnitZ(), reference = is_sphere ? Vec3(1, 0, 0) : Vec3(0, 0, 0);
  if (axis_pointer != 0 || !is_sphere) axis = pointed_vector(reading, axis_pointer, 123, in).value_or(axis);
  if (reference_pointer != 0)
    reference = pointed_vector(reading, reference_pointer, 123, in).value_or(reference);
  if (!in.ok()) return std::nullopt;
  constexpr std::array<Kind, 5> kinds = {Kind::plane, Kind::cylinder, Kind::cone, Kind::sphere, Kind::torus};
  nurbs::Analytic shape = nurbs::Analytic::placed(kinds[static_cast<std::size_t>(entry.type - 190) / 2],
                                                  *origin, axis, reference);
  shape.radius = radius;
  shape.half_angle = second * std::numbers::pi / 180;
  shape.minor = second;
  return shape;
}

std::optional<nurbs::Surface> read_whole(Reading& reading, const DirectoryEntry& entry, Parameters& in) {
  const std::optional<nurbs::Analytic> shape = read_analytic(reading, entry, in);
  if (!shape) return std::nullopt;
  if (!shape->is_finite()) return in.give_up("it has no end, and nothing bounds it here");
  return shape->part(shape->whole());
}

std::span<const EntityType> analytic_types() {
  static constexpr std::array<EntityType, 6> types = {
      {{.number = 108, .face = read_bounded_plane},
       {.number = 190, .surface = read_whole, .has_form = is_simple_form},
       {.number = 192, .surface = read_whole, .has_form = is_simple_form},
       {.number = 194, .surface = read_whole, .has_form = is_simple_form},
       {.number = 196, .surface = read_whole, .has_form = is_simple_form},
       {.number = 198, .surface = read_whole, .has_form = is_simple_form}}};
  return types;
}

}  // namespace selvage::formats::iges
