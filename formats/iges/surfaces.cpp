// 114, 118, 120, 122: surfaces made of polynomials or of curves. And curves in the parameters of surfaces.
#include "formats/iges/surfaces.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "cad/edges.h"
#include "cad/natural_border.h"
#include "cad/sampled_curve.h"
#include "formats/iges/curves.h"
#include "formats/iges/standard.h"
#include "formats/iges/types.h"
#include "nurbs/chain.h"
#include "nurbs/conic.h"
#include "nurbs/divided.h"
#include "nurbs/interpolate.h"
#include "nurbs/measure.h"
#include "nurbs/power.h"
#include "nurbs/restrict.h"
#include "nurbs/sweep.h"

namespace selvage::formats::iges {

namespace {

using nurbs::Curve;
using nurbs::Surface;
using std::numbers::pi;

std::optional<Surface> read_patches(Reading& reading, const DirectoryEntry& entry, Parameters& in) {
  in.integer();  // kind of spline
  in.integer();  // kind of patch
  const std::size_t m = in.count("patches", 48), n = in.count("patches", 48);
  if (in.ok() && (m == 0 || n == 0)) in.fail("a surface without patches");
  if (in.ok() && m * (n + 1) > in.room() / 48)
    in.fail(fmt::format("{} x {} patches: more than the entity's lines can hold", m, n));
  const auto breaks_u = in.ok() ? read_breaks(in, m) : std::nullopt;
  const auto breaks_v = breaks_u ? read_breaks(in, n) : std::nullopt;
  if (!breaks_v) return std::nullopt;
  std::vector<nurbs::Bicubic> patches(m * n);
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j <= n; ++j) {  // the last one of a row means nothing
      nurbs::Bicubic patch{};
      for (int axis = 0; axis < 3; ++axis)
        for (std::size_t l = 0; l < 4; ++l)
          for (std::size_t k = 0; k < 4; ++k) patch[k][l][axis] = in.real();
      if (j < n) patches[j * m + i] = patch;
    }
  // So does the last row, which some leave out.
  if (in.ok() && in.room() >= 48 * (n + 1))
    for (std::size_t i = 0; i < 48 * (n + 1); ++i) in.skip();
  if (!in.ok()) return std::nullopt;
  double gap = 0;
  Surface surface = nurbs::from_power(*breaks_u, *breaks_v, patches, &gap);
  if (gap > most_gap(surface.points))
    return in.give_up(fmt::format("its patches do not meet, by {:.3g}", gap));
  warn_of_gap(reading, entry, gap, surface.points);
  return surface;
}

// The curve with its length as its parameter: polylines exactly, others by cubics to some 1e-9 of the length,
// piece by piece between corners.
Curve by_length(const Curve& given) {
  if (given.degree == 1 && !given.is_rational()) {
    Curve curve = nurbs::restricted(given, given.first_parameter(), given.last_parameter());
    for (std::size_t i = 1; i < curve.points.size(); ++i)
      curve.knots[i + 1] = curve.knots[i] + (curve.points[i] - curve.points[i - 1]).norm();
    curve.knots.back() = curve.knots[curve.knots.size() - 2];
    return curve;
  }
  const std::vector<double> breaks = nurbs::breakpoints(given.knots, given.degree);
  const std::size_t steps = std::clamp<std::size_t>(4096 / breaks.size(), 4, 256);
  std::vector<Curve> pieces;
  std::vector<Vec3> points;
  std::vector<double> lengths;
  const auto slope = [&](double t) -> Vec3 { return nurbs::evaluate_jet(given, t).d1.normalized(); };
  double start = breaks.front(), piece_start = start;
  const double tiny = 1e-9 * (breaks.back() - breaks.front());
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    for (std::size_t k = 0; k < steps; ++k) {
      const double t =
          breaks[i] + (breaks[i + 1] - breaks[i]) * static_cast<double>(k) / static_cast<double>(steps);
      if (!points.empty()) lengths.push_back(lengths.back() + nurbs::arc_length(given, start, t));
      if (points.empty()) lengths.push_back(0);
      points.push_back(nurbs::evaluate(given, t));
      start = t;
    }
    const double t = breaks[i + 1];
    const bool corner = std::count(given.knots.begin(), given.knots.end(), t) >= given.degree &&
                        i + 2 < breaks.size() && (slope(t - tiny) - slope(t + tiny)).norm() > 1e-6;
    if (!corner && i + 2 < breaks.size()) continue;
    lengths.push_back(lengths.back() + nurbs::arc_length(given, start, t));
    points.push_back(nurbs::evaluate(given, t));
    start = t;
    const double slope_at = pieces.empty() ? piece_start : piece_start + tiny;
    pieces.push_back(nurbs::interpolate(points, lengths, slope(slope_at), slope(corner ? t - tiny : t)));
    piece_start = t;
    points.clear();
    lengths.clear();
  }
  return nurbs::chained(pieces);
}

// A rail of a 118 with the parameter that the form asks for.
struct Rail {
  Curve curve;
  std::optional<ArcFrame> arc;
};

std::optional<Rail> read_rail(Reading& reading, int pointer, Parameters& in) {
  std::optional<Curve> curve = reading.curve(pointer, in);
  if (!curve) return std::nullopt;
  Rail rail{std::move(*curve), std::nullopt};
  const DirectoryEntry& entry = *reading.file().entity(pointer);
  if (entry.type == 100) {
    Parameters again = reading.file().parameters(entry);
    rail.arc = read_arc_frame(reading, entry, again);
    if (rail.arc) {
      const Placement placement = reading.placement(entry);
      const Vec3 center = placement(rail.arc->center);
      rail.arc->x = placement(rail.arc->center + rail.arc->x) - center;
      rail.arc->y = placement(rail.arc->center + rail.arc->y) - center;
      rail.arc->center = center;
    }
  }
  return rail;
}

bool is_straight(const Rail& rail) {
  return rail.curve.degree == 1 && rail.curve.points.size() == 2;
}

std::optional<Surface> read_ruled(Reading& reading, const DirectoryEntry& entry, Parameters& in) {
  const int first_pointer = in.pointer(), second_pointer = in.pointer();
  const bool backwards = in.integer() == 1;
  in.integer();  // developable or not
  std::optional<Rail> first = read_rail(reading, first_pointer, in),
                      second = read_rail(reading, second_pointer, in);
  if (!in.ok() || !first || !second) return std::nullopt;
  // Arcs as far as each other run alike as B-splines; any other pair by the angle itself.
  const bool alike =
      first->arc && second->arc &&
      std::abs((first->arc->to - first->arc->from) - (second->arc->to - second->arc->from)) < 1e-9;
  for (Rail* const rail : {&*first, &*second}) {
    if (alike || is_straight(*rail)) continue;
    if (rail->arc)
      rail->curve =
          nurbs::arc_by_angle(rail->arc->center, rail->arc->x, rail->arc->y, rail->arc->from, rail->arc->to);
    else if (entry.form == 0)
      rail->curve = by_length(rail->curve);
  }
  if (backwards) second->curve = nurbs::reversed(second->curve);
  return nurbs::ruled(first->curve, second->curve);
}

std::optional<Surface> read_revolution(Reading& reading, const DirectoryEntry& entry, Parameters& in) {
  const int axis_pointer = in.pointer(), curve_pointer = in.pointer();
  double from = in.real(), to = in.real();
  const std::optional<Curve> axis = reading.curve(axis_pointer, in);
  const std::optional<Curve> generatrix = reading.curve(curve_pointer, in);
  if (!in.ok() || !axis || !generatrix) return std::nullopt;
  const Vec3 foot = axis->points.front(), direction = axis->points.back() - foot;
  if (axis->degree != 1 || axis->points.size() != 2 || !(direction.norm() > 0))
    return in.fail("its axis is no line");
  if (from == to) return in.fail(fmt::format("it is turned from {} to {} radians: by nothing", from, to));
  if (to < from) to += 2 * pi * std::ceil((from - to) / (2 * pi));
  if (std::abs(to - from - 2 * pi) < 1e-5) {  // of so many digits, files have 6.28318
    to = from + 2 * pi;
  } else if (to - from > 2 * pi) {
    reading.warning(entry, fmt::format("it is turned by {} radians; a whole turn is taken", to - from));
    to = from + 2 * pi;
  }
  return nurbs::revolved(*generatrix, foot, direction, from, to);
}

std::optional<Surface> read_extrusion(Reading& reading, const DirectoryEntry& /*entry*/, Parameters& in) {
  const int pointer = in.pointer();
  const Vec3 end = read_point(in);
  const std::optional<Curve> directrix = reading.curve(pointer, in);
  if (!in.ok() || !directrix) return std::nullopt;
  const Vec3 shift = end - cad::at_share(*directrix, 0);
  if (!(shift.norm() > 0)) return in.fail("it ends where its curve starts: it has no height");
  return nurbs::extruded(*directrix, shift);
}

// Of the first curve of a 120, 122; 0: none.
int type_of_curve(Reading& reading, const DirectoryEntry& entry) {
  Parameters in = reading.file().parameters(entry);
  int pointer = in.pointer();
  if (entry.type == 120) pointer = in.pointer();
  const DirectoryEntry* const curve = in.ok() ? reading.file().entity(pointer) : nullptr;
  return curve != nullptr ? curve->type : 0;
}

bool has_angles(int type) {
  return type == 100 || type == 104;
}

}  // namespace

FlatMap::FlatMap(Reading& reading, int pointer, const Surface& surface) {
  const DirectoryEntry* const entry = reading.file().entity(pointer);
  if (entry == nullptr || is_analytic(reading, *entry) || entry->type == 118) {
    is_known_ = false;
    return;
  }
  const auto breaks_u = [&] { return nurbs::breakpoints(surface.knots_u, surface.degree_u); };
  if (entry->type == 120) v_.angles = nurbs::breakpoints(surface.knots_v, surface.degree_v);
  if (entry->type == 120 || entry->type == 122) {
    const int curve = type_of_curve(reading, *entry);
    is_known_ = curve != 102;
    if (has_angles(curve)) u_.angles = breaks_u();
  }
  if (entry->type == 122) {  // there u is 0 to 1, whatever the curve has
    u_.shift = surface.first_u();
    u_.scale = surface.last_u() - surface.first_u();
  }
}

double FlatMap::Axis::operator()(double value) const {
  const double own = is_identity() ? value : shift + scale * value;
  return angles.empty() ? own : nurbs::parameter_at_angle(angles, own);
}

std::optional<Curve> FlatMap::operator()(const Curve& flat) const {
  if (!is_known_) return std::nullopt;
  if (u_.is_identity() && v_.is_identity()) return flat;
  const auto point_by_point = [&] {
    Curve mapped = flat;
    for (Vec3& p : mapped.points) p = at(p);
    return mapped;
  };
  if (u_.angles.empty() && v_.angles.empty()) return point_by_point();
  const auto constant = [&](int axis) {
    return std::all_of(flat.points.begin(), flat.points.end(),
                       [&](const Vec3& p) { return p[axis] == flat.points.front()[axis]; });
  };
  if (constant(0) || constant(1)) {
    const int axis = constant(0) ? 1 : 0;
    if ((axis == 0 ? u_ : v_).angles.empty() || flat.degree == 1) return point_by_point();
    return nurbs::segment(at(cad::at_share(flat, 0)), at(cad::at_share(flat, 1)), flat.first_parameter(),
                          flat.last_parameter());
  }
  const std::vector<double> parameters = nurbs::divided(flat.knots, flat.degree, 32);
  std::vector<Vec3> points;
  points.reserve(parameters.size());
  for (const double t : parameters) points.push_back(at(nurbs::evaluate(flat, t)));
  return nurbs::interpolate(points, parameters, nurbs::end_derivative(points, parameters, false),
                            nurbs::end_derivative(points, parameters, true));
}

void align_flat(cad::Edge& edge, const nurbs::Surface& surface) {
  if (edge.curve.points.empty() || edge.flat.points.empty()) return;
  const Vec3 start = cad::at_share(surface, edge.flat, 0), end = cad::at_share(surface, edge.flat, 1);
  const Vec3 from = cad::at_share(edge.curve, 0), to = cad::at_share(edge.curve, 1);
  if ((start - from).norm() + (end - to).norm() > (start - to).norm() + (end - from).norm())
    edge.flat = nurbs::reversed(edge.flat);
}

namespace {

// One by formula, as far as the loops reach.
std::optional<Surface> bounded_surface(Reading& reading, const DirectoryEntry& entry,
                                       const std::vector<cad::Loop>& loops, Parameters& by) {
  reading.use(entry.pointer);
  const std::optional<nurbs::Analytic> shape =
      reading.inside(&entry, by, [&](Parameters& in) { return read_analytic(reading, entry, in); });
  if (!shape) return std::nullopt;
  const Placement placement = reading.placement(entry);
  const Eigen::Matrix3d inverse = placement.linear.inverse();
  std::vector<std::vector<Vec3>> points;
  for (const cad::Loop& loop : loops) {
    points.push_back(points_along(loop));
    if (!placement.is_identity)
      for (Vec3& p : points.back()) p = inverse * (p - placement.shift);
  }
  std::optional<nurbs::Analytic::Range> range = shape->bounded_by(points);
  if (!range && shape->is_finite()) range = shape->whole();
  if (!range)
    return by.give_up(fmt::format("its loops do not bound D{}, a {} ({})", entry.pointer, entry.type,
                                  entity_title(entry.type)));
  cad::Face face;
  face.loops = loops;
  for (cad::Edge& edge : cad::edges_of(face)) edge.flat = {};  // in the file's parameters, still
  face.surface = shape->part(*range);
  placement.apply(face.surface);
  const double tolerance = cad::border_tolerance(face, reading.file().global().resolution);
  if (!cad::has_natural_border(face, tolerance)) {
    face.surface = shape->part(shape->widened(*range));
    placement.apply(face.surface);
  }
  return std::move(face.surface);
}

}  // namespace

std::optional<FlatMap> put_surface(Reading& reading, int pointer, cad::Face& face, Parameters& by) {
  const DirectoryEntry* const entry = reading.entry(pointer, by);
  if (entry == nullptr) return std::nullopt;
  std::optional<Surface> surface = is_analytic(reading, *entry)
                                       ? bounded_surface(reading, *entry, face.loops, by)
                                       : reading.surface(pointer, by);
  if (!surface) return std::nullopt;
  face.surface = std::move(*surface);
  if (entry->type != 140 || is_analytic(reading, *entry)) return FlatMap(reading, pointer, face.surface);
  Parameters in = reading.file().parameters(*entry);
  const int base = read_offset(in)->base;
  surface = reading.surface(base, by);
  if (!surface) return std::nullopt;
  return FlatMap(reading, base, *surface);
}

std::span<const EntityType> surface_types() {
  static constexpr std::array<EntityType, 4> types = {{{.number = 114, .surface = read_patches},
                                                       {.number = 118, .surface = read_ruled},
                                                       {.number = 120, .surface = read_revolution},
                                                       {.number = 122, .surface = read_extrusion}}};
  return types;
}

}  // namespace selvage::formats::iges
