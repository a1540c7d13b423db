// 100, 102, 104, 106, 110, 112: curves that become B-splines, all exactly.
#include "formats/iges/curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "cad/sampled_curve.h"
#include "formats/iges/types.h"
#include "nurbs/chain.h"
#include "nurbs/conic.h"
#include "nurbs/power.h"
#include "nurbs/restrict.h"

namespace selvage::formats::iges {

namespace {

using nurbs::Curve;
using std::numbers::pi;

// A polyline through points of which no neighbours coincide, over `knots` if they fit, else over 0, 1, 2, ...
Curve polyline(const std::vector<Vec3>& points) {
  Curve curve;
  curve.degree = 1;
  curve.points = points;
  curve.knots.push_back(0);
  for (std::size_t i = 0; i < points.size(); ++i) curve.knots.push_back(static_cast<double>(i));
  curve.knots.push_back(curve.knots.back());
  return curve;
}

// Composites within composites: a file of few lines may say very much with them.
constexpr std::size_t cost_of_nesting = 300;  // in control points
constexpr std::size_t deepest_nesting = 30;

std::vector<Curve> read_links(Reading& reading, Parameters& in, std::vector<int>& trail);

// The curve at `pointer`, or those of the composite there. `trail`: the composites that hold it.
std::vector<Curve> read_links(Reading& reading, int pointer, Parameters& by, std::vector<int>& trail) {
  const DirectoryEntry* const entry = reading.entry(pointer, by);
  if (entry == nullptr) return {};
  std::vector<Curve> links;
  if (entry->type != 102) {
    if (std::optional<Curve> curve = reading.curve(pointer, by)) links.push_back(std::move(*curve));
    return links;
  }
  reading.use(pointer);
  if (std::find(trail.begin(), trail.end(), entry->pointer) != trail.end())
    by.fail(fmt::format("D{} is part of itself", pointer));
  else if (trail.size() > deepest_nesting)
    by.fail(fmt::format("D{} is nested in more than {} others", pointer, deepest_nesting));
  if (!by.ok() || (trail.size() > 1 && !reading.spend(cost_of_nesting, by))) return {};
  trail.push_back(entry->pointer);
  const auto read = [&](Parameters& in) { return std::optional(read_links(reading, in, trail)); };
  links = reading.inside(entry, by, read).value_or(links);
  trail.pop_back();
  if (!links.empty()) reading.placement(*entry).apply(links);
  return links;
}

// Those of the composite whose parameters are `in`; points among them mean nothing for its shape.
std::vector<Curve> read_links(Reading& reading, Parameters& in, std::vector<int>& trail) {
  const std::size_t count = in.count("curves");
  std::vector<Curve> links;
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    const int pointer = in.pointer();
    const DirectoryEntry* const part = reading.entry(pointer, in);
    if (part == nullptr) break;
    if (is_point(*part))
      reading.use(pointer);
    else
      for (Curve& curve : read_links(reading, pointer, in, trail)) links.push_back(std::move(curve));
  }
  if (in.ok() && links.empty()) in.fail("it has no curves");
  if (!in.ok()) links.clear();
  return links;
}

Vec2 read_pair(Parameters& in) {
  const double x = in.real(), y = in.real();
  return {x, y};
}

std::optional<Curve> read_arc(Reading& reading, const DirectoryEntry& entry, Parameters& in) {
  const std::optional<ArcFrame> arc = read_arc_frame(reading, entry, in);
  if (!arc) return std::nullopt;
  Curve curve = nurbs::elliptic_arc(arc->center, arc->x, arc->y, arc->from, arc->to);
  curve.points.front() = arc->start;
  curve.points.back() = arc->end;
  return curve;
}

std::optional<Curve> read_conic(Reading& /*reading*/, const DirectoryEntry& entry, Parameters& in) {
  std::array<double, 6> coefficients{};
  for (double& coefficient : coefficients) coefficient = in.real();
  const double z = in.real();
  const Vec2 from = read_pair(in), to = read_pair(in);
  if (!in.ok()) return std::nullopt;
  const auto kind = entry.form >= 1 && entry.form <= 3 ? static_cast<nurbs::ConicKind>(entry.form)
                                                       : nurbs::ConicKind::unknown;
  nurbs::ConicArc arc = nurbs::conic_arc(coefficients, z, from, to, kind);
  if (!arc.curve) in.fail(arc.fault);
  return std::move(arc.curve);
}

std::optional<Curve> read_line(Reading& /*reading*/, const DirectoryEntry& entry, Parameters& in) {
  const Vec3 from = read_point(in), to = read_point(in);
  if (in.ok() && entry.form != 0) in.give_up("it is a line without end");
  if (!in.ok()) return std::nullopt;
  return nurbs::segment(from, to);
}

bool is_polyline(int form) {
  return form == 11 || form == 12 || form == 13 || form == 63;
}
bool is_read_copious(int form) {
  return is_polyline(form) || (form >= 1 && form <= 3);
}

// Forms 1 to 3 are points: known, and no curve.
std::optional<Curve> read_copious(Reading& /*reading*/, const DirectoryEntry& entry, Parameters& in) {
  const std::int64_t kind = in.integer();
  if (in.ok() && (kind < 1 || kind > 3)) in.fail(fmt::format("there are no points of kind {}", kind));
  const std::size_t each = kind == 1 ? 2 : kind == 2 ? 3 : 6;
  const std::size_t count = in.count("points", each);
  const double z = kind == 1 ? in.real() : 0;
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    const Vec2 flat = read_pair(in);
    points.emplace_back(flat.x(), flat.y(), kind == 1 ? z : in.real());
    for (std::size_t k = 3; k < each; ++k) in.real();  // a direction at the point
  }
  if (!in.ok() || !is_polyline(entry.form)) return std::nullopt;
  if (points.size() < 2) return in.fail(fmt::format("a polyline of {} points", points.size()));
  return polyline(points);
}

std::optional<Curve> read_spline(Reading& reading, const DirectoryEntry& entry, Parameters& in) {
  for (int flag = 1; flag <= 3; ++flag) in.integer();  // kind of spline, continuity, dimension
  const std::size_t count = in.count("pieces", 13);
  if (in.ok() && count == 0) in.fail("a spline without pieces");
  const std::optional<std::vector<double>> breaks = in.ok() ? read_breaks(in, count) : std::nullopt;
  if (!breaks) return std::nullopt;
  std::vector<nurbs::Cubic> pieces(count);
  for (nurbs::Cubic& piece : pieces)
    for (int axis = 0; axis < 3; ++axis)
      for (Vec3& coefficient : piece) coefficient[axis] = in.real();
  for (int value = 0; value < 12; ++value) in.real();  // the last point and its derivatives
  if (!in.ok()) return std::nullopt;
  double gap = 0;
  Curve curve = nurbs::from_power(*breaks, pieces, &gap);
  warn_of_gap(reading, entry, gap, curve.points);
  return curve;
}

// Each piece turned towards the end of the one before it, where that makes them meet.
std::vector<Curve> turned_to_meet(const std::vector<Curve>& pieces) {
  std::vector<Curve> best = pieces;
  for (const bool turn_first : {false, true}) {
    std::vector<Curve> turned = pieces;
    if (turn_first) turned.front() = nurbs::reversed(turned.front());
    for (std::size_t i = 1; i < turned.size(); ++i) {
      const Vec3 end = cad::at_share(turned[i - 1], 1);
      if ((cad::at_share(turned[i], 1) - end).norm() < (cad::at_share(turned[i], 0) - end).norm())
        turned[i] = nurbs::reversed(turned[i]);
    }
    if (nurbs::largest_gap(turned) < nurbs::largest_gap(best)) best = std::move(turned);
  }
  return best;
}

// The pieces as they are, those of composites in it one by one; empty after an error.
std::vector<Curve> read_pieces(Reading& reading, const DirectoryEntry& entry, Parameters& in) {
  std::vector<int> trail = {entry.pointer};
  std::vector<Curve> pieces = read_links(reading, in, trail);
  turn_to_meet(reading, entry, pieces);
  return pieces;
}

// The pieces as one curve, or as they are where they do not meet; `gap` is the largest between them.
std::vector<Curve> joined(Reading& reading, const DirectoryEntry& entry, std::vector<Curve> pieces,
                          double& gap) {
  if (pieces.empty()) return pieces;
  std::vector<Vec3> points;
  for (const Curve& piece : pieces) points.insert(points.end(), piece.points.begin(), piece.points.end());
  gap = nurbs::largest_gap(pieces);
  if (gap > most_gap(points)) return pieces;
  warn_of_gap(reading, entry, gap, points);
  return {nurbs::chained(pieces)};
}

std::optional<Curve> read_composite(Reading& reading, const DirectoryEntry& entry, Parameters& in) {
  double gap = 0;
  std::vector<Curve> pieces = joined(reading, entry, read_pieces(reading, entry, in), gap);
  if (pieces.size() > 1) return in.give_up(fmt::format("its curves do not meet, by {:.3g}", gap));
  return pieces.empty() ? std::nullopt : std::optional(std::move(pieces.front()));
}

// By itself it may be in pieces.
void stand_composite(Reading& reading, const DirectoryEntry& entry, Parameters& in, const Context& context) {
  double gap = 0;
  std::vector<Curve> pieces = joined(reading, entry, read_pieces(reading, entry, in), gap);
  if (pieces.size() > 1)
    reading.warning(
        entry, fmt::format("its curves do not meet, by {:.3g}: they stay {} curves", gap, pieces.size()));
  reading.stand_curves(entry, context, in, std::move(pieces));
}

bool is_ordinary_line(int form) {
  return form >= 0 && form <= 2;
}

}  // namespace

Vec3 read_point(Parameters& in) {
  const double x = in.real(), y = in.real(), z = in.real();
  return {x, y, z};
}

bool is_point(const DirectoryEntry& entry) {
  return entry.type == 116 || entry.type == 132;
}

std::optional<ArcFrame> read_arc_frame(Reading& reading, const DirectoryEntry& entry, Parameters& in) {
  const double z = in.real();
  const Vec2 center = read_pair(in), start = read_pair(in), end = read_pair(in);
  if (!in.ok()) return std::nullopt;
  const Vec2 a = start - center, b = end - center;
  const double radius = a.norm();
  if (!(radius > 0)) return in.fail("an arc of radius 0");
  const double miss = std::abs(b.norm() - radius);
  if (miss > 1e-3 * radius)
    return in.fail(fmt::format("its ends are {} and {} from its centre", radius, b.norm()));
  if (miss > 1e-6 * radius)
    reading.warning(
        entry, fmt::format("its ends are {} and {} from its centre; the first counts", radius, b.norm()));
  ArcFrame arc;
  const auto lifted = [z](const Vec2& p) { return Vec3(p.x(), p.y(), z); };
  arc.center = lifted(center);
  arc.x = Vec3(radius, 0, 0);
  arc.y = Vec3(0, radius, 0);
  arc.start = lifted(start);
  arc.end = lifted(end);
  arc.from = std::atan2(a.y(), a.x());
  arc.to = std::atan2(b.y(), b.x());
  // Ends that nearly coincide, too, mean all of it: nobody draws an arc that short.
  if ((start - end).norm() <= 1e-9 * radius) {
    arc.to = arc.from + 2 * pi;
    arc.end = arc.start;
  }
  while (arc.to <= arc.from) arc.to += 2 * pi;
  return arc;
}

std::optional<std::vector<double>> read_breaks(Parameters& in, std::size_t pieces) {
  std::vector<double> breaks(pieces + 1);
  if (!in.reals(breaks.data(), breaks.size())) return std::nullopt;
  for (std::size_t i = 1; i < breaks.size(); ++i)
    if (!(breaks[i] > breaks[i - 1]))
      return in.fail(
          fmt::format("breakpoint {} is {}, the one before it {}", i + 1, breaks[i], breaks[i - 1]));
  return breaks;
}

std::vector<Vec3> points_along(const cad::Loop& loop) {
  constexpr std::size_t most = 20'000;  // an edge
  std::vector<Vec3> points;
  for (const cad::Edge& edge : loop.edges) {
    if (edge.curve.points.empty()) continue;
    const std::vector<double> breaks = nurbs::breakpoints(edge.curve.knots, edge.curve.degree);
    const int steps = breaks.size() > most / 16 ? 2 : 16;
    for (std::size_t i = 0; i + 1 < breaks.size(); ++i)
      for (int k = 0; k < steps; ++k)
        points.push_back(nurbs::evaluate(edge.curve, breaks[i] + (breaks[i + 1] - breaks[i]) * k / steps));
    points.push_back(nurbs::evaluate(edge.curve, breaks.back()));
  }
  return points;
}

double size_of(const std::vector<Vec3>& points) {
  return points.empty() ? 0 : cad::box_of(points).sizes().norm();
}

double most_gap(const std::vector<Vec3>& points) {
  return 1e-3 * size_of(points);
}

void warn_of_gap(Reading& reading, const DirectoryEntry& entry, double gap, const std::vector<Vec3>& points) {
  const double allowed = std::max(1e-6 * size_of(points), 2 * reading.file().global().resolution);
  if (gap > allowed)
    reading.warning(entry, fmt::format("its pieces do not meet, by {:.3g}; they are joined", gap));
}

void turn_to_meet(Reading& reading, const DirectoryEntry& entry, std::vector<Curve>& pieces) {
  if (pieces.size() < 2) return;
  std::vector<Vec3> points;
  for (const Curve& piece : pieces) points.insert(points.end(), piece.points.begin(), piece.points.end());
  if (nurbs::largest_gap(pieces) <= most_gap(points)) return;
  std::vector<Curve> turned = turned_to_meet(pieces);
  if (nurbs::largest_gap(turned) > 0.01 * most_gap(points)) return;
  pieces = std::move(turned);
  reading.warning(entry, "its curves run against each other; some are turned, so that they meet");
}

std::vector<Curve> read_chain(Reading& reading, int pointer, Parameters& by) {
  std::vector<int> trail;
  return read_links(reading, pointer, by, trail);
}

std::span<const EntityType> curve_types() {
  static constexpr std::array<EntityType, 8> types = {
      {{.number = 100, .curve = read_arc},
       {.number = 102, .curve = read_composite, .stand = stand_composite},
       {.number = 104, .curve = read_conic},
       {.number = 106, .curve = read_copious, .has_form = is_read_copious},
       {.number = 110, .curve = read_line, .has_form = is_ordinary_line},
       {.number = 112, .curve = read_spline},
       {.number = 116},
       {.number = 123}}};
  return types;
}

}  // namespace selvage::formats::iges
