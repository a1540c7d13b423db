// 130 and 140: curves and surfaces at a distance from others, fitted.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "formats/iges/curves.h"
#include "formats/iges/surfaces.h"
#include "formats/iges/types.h"
#include "nurbs/conic.h"
#include "nurbs/measure.h"
#include "nurbs/offset.h"
#include "nurbs/restrict.h"

namespace selvage::formats::iges {

namespace {

using nurbs::Curve;
using nurbs::Surface;

constexpr double wanted_share = 1e-8;  // of the size: how near a fitted shape is to what the file says
constexpr double worst_share = 1e-4;   // beyond that there is an edge in what it is offset from

template <class Shape>
bool is_near(Reading& reading, const DirectoryEntry& entry, const nurbs::Fitted<Shape>& made, double size,
             Parameters& in) {
  if (!std::isfinite(made.error) || made.error > worst_share * size) {
    in.give_up(fmt::format("what it is offset from has a corner or a cusp, where it would be torn by {:.3g}",
                           made.error));
    return false;
  }
  if (made.error > std::max(1e-6 * size, reading.file().global().resolution))
    reading.warning(entry, fmt::format("its offset is met to {:.3g} only", made.error));
  return true;
}

// What a 130 says of its distance: one, or from one to another, or a coordinate of a curve, by length or
// parameter.
struct Distance {
  std::int64_t kind = 0, axis = 0, by = 0;
  std::array<double, 4> values{};  // first distance and its place, second distance and its place
};

// Composites and conics have other parameters as B-splines than the standard gives to them.
bool keeps_parameters(const DirectoryEntry& entry) {
  return entry.type != 102 && entry.type != 104;
}

// The base with the parameter that the standard gives to it, where that is kept.
std::optional<Curve> base_curve(Reading& reading, int pointer, Parameters& in) {
  std::optional<Curve> curve = reading.curve(pointer, in);
  if (!curve) return std::nullopt;
  const DirectoryEntry& entry = *reading.file().entity(pointer);
  if (entry.type != 100) return curve;
  Parameters again = reading.file().parameters(entry);
  const std::optional<ArcFrame> arc = read_arc_frame(reading, entry, again);
  if (!arc) return curve;
  Curve by_angle = nurbs::arc_by_angle(arc->center, arc->x, arc->y, arc->from, arc->to);
  reading.placement(entry).apply(by_angle);
  return by_angle;
}

std::optional<Curve> read_offset_curve(Reading& reading, const DirectoryEntry& entry, Parameters& in) {
  const int base_pointer = in.pointer();
  Distance distance;
  distance.kind = in.integer();
  const int function_pointer = in.pointer();
  distance.axis = in.integer();
  distance.by = in.integer();
  for (double& value : distance.values) value = in.real();
  const Vec3 normal = read_point(in).normalized();
  const double from = in.real(), to = in.real();
  if (in.ok() && (distance.kind < 1 || distance.kind > 3))
    in.fail(fmt::format("there is no offset of kind {}", distance.kind));
  if (in.ok() && !(normal.norm() > 0)) in.fail("an offset without a normal");
  if (in.ok() && distance.kind == 3 && (distance.axis < 1 || distance.axis > 3))
    in.fail(fmt::format("a curve has no coordinate {}", distance.axis));
  std::optional<Curve> base = in.ok() ? base_curve(reading, base_pointer, in) : std::nullopt;
  std::optional<Curve> function;
  if (base && distance.kind == 3) function = reading.curve(function_pointer, in);
  if (!in.ok() || !base || (distance.kind == 3 && !function)) return std::nullopt;
  const bool is_kept = keeps_parameters(*reading.file().entity(base_pointer));
  if (!is_kept && distance.kind != 1 && distance.by != 1)
    return in.give_up("its distance goes by the parameter of a composite or a conic, which is not kept");
  // Both 0: not said.
  if (is_kept && from < to && from >= base->first_parameter() - 1e-9 && to <= base->last_parameter() + 1e-9)
    base = nurbs::restricted(*base, std::max(from, base->first_parameter()),
                             std::min(to, base->last_parameter()));
  else if (from != to)
    reading.warning(
        entry, is_kept ? fmt::format("its curve has no parameters {} to {}; all of it is taken", from, to)
                       : "all of the composite or conic is taken, wherever it is to begin and end");
  const double start = base->first_parameter();
  const auto at_place = [&](double t) {
    const auto& [d1, t1, d2, t2] = distance.values;
    if (distance.kind == 1) return d1;
    const double place = distance.by == 1 ? nurbs::arc_length(*base, start, t) : t;
    if (distance.kind == 2) return t1 == t2 ? d1 : d1 + (d2 - d1) * (place - t1) / (t2 - t1);
    return nurbs::evaluate(*function, place)[distance.axis - 1];
  };
  const auto at = [&](double t) -> Vec3 {
    const nurbs::CurveJet jet = nurbs::evaluate_jet(*base, t);
    return jet.position + at_place(t) * normal.cross(jet.d1.normalized());
  };
  const double size = size_of(base->points) + std::abs(at_place(start));
  nurbs::Fitted<Curve> made =
      nurbs::fitted(nurbs::breakpoints(base->knots, base->degree), at, wanted_share * size);
  if (!is_near(reading, entry, made, size, in)) return std::nullopt;
  return std::move(made.shape);
}

std::optional<Surface> read_offset_surface(Reading& reading, const DirectoryEntry& entry, Parameters& in) {
  if (is_analytic(reading, entry)) return read_whole(reading, entry, in);
  const std::optional<OffsetOf> offset = read_offset(in);
  if (!offset) return std::nullopt;
  const std::optional<Surface> base = reading.surface(offset->base, in);
  if (!base) return std::nullopt;
  const Vec3 normal = nurbs::unit_normal(*base, 0.5 * (base->first_u() + base->last_u()),
                                         0.5 * (base->first_v() + base->last_v()));
  const double distance = offset->side.dot(normal) < 0 ? -offset->distance : offset->distance,
               size = size_of(base->points) + std::abs(distance);
  nurbs::Fitted<Surface> made = nurbs::offset(*base, distance, wanted_share * size);
  if (!is_near(reading, entry, made, size, in)) return std::nullopt;
  return std::move(made.shape);
}

}  // namespace

std::optional<OffsetOf> read_offset(Parameters& in) {
  OffsetOf offset;
  offset.side = read_point(in);
  offset.distance = in.real();
  offset.base = in.pointer();
  return in.ok() ? std::optional(offset) : std::nullopt;
}

std::span<const EntityType> offset_types() {
  static constexpr std::array<EntityType, 2> types = {
      {{.number = 130, .curve = read_offset_curve}, {.number = 140, .surface = read_offset_surface}}};
  return types;
}

}  // namespace selvage::formats::iges
