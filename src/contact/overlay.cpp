#include "contact/overlay.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "contact/critical.h"
#include "core/plane.h"
#include "nurbs/patch.h"

namespace selvage::contact {

Sheet::Sheet(const CellModel& model, std::vector<Part> of, int steps_a_part)
    : parts(std::move(of)), steps(steps_a_part) {
  points.reserve(parts.size() * points_a_part());
  std::vector<Vec3> sampled;
  for (const Part& part : parts) {
    const Face& face = model.face_of(model.cells()[part.cell]);
    sample(patch_of(*face.surface, part.low, part.high), steps, steps, sampled);
    points.insert(points.end(), sampled.begin(), sampled.end());
  }
}

Axes::Axes(const Vec3& direction, const std::vector<Vec3>& points)
    : x(direction.unitOrthogonal()), y(direction.cross(x)), n(direction) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : points) middle += p / static_cast<double>(points.size());
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const Vec3& p : points) {
    const Vec3 way = seen(p - middle);
    xx += way.x() * way.x();
    xy += way.x() * way.y();
    yy += way.y() * way.y();
  }
  const double turn = 0.5 * std::atan2(2.0 * xy, xx - yy);
  x = std::cos(turn) * x + std::sin(turn) * y;
  y = n.cross(x);
}

Vec3 turned(const Vec3& n, double step, int k) {
  const Vec3 x = n.unitOrthogonal(), y = n.cross(x);
  const double angle = k * std::numbers::pi / 4.0 + 10.0 * step;
  return (n + step * (std::cos(angle) * x + std::sin(angle) * y)).normalized();
}

Overlay::Overlay(const CellModel& model, const Sheet& a, const Sheet& b, const Axes& axes,
                 const Rectangle& rectangle, int lines)
    : model_(model),
      sheet_a_(a),
      sheet_b_(b),
      axes_(axes),
      raster_(rectangle, lines),
      a_(raster_.size()),
      b_(a_.size()) {
  pass(a, Keep::highest_out, {}, a_);
  pass(b, Keep::lowest_in, {}, b_);
  drop_passing();
}

int Overlay::line_at(const Vec2& p) const {
  const Vec2 at = (p - raster_.low).cwiseQuotient(raster_.step);
  const double i = std::floor(at.x()), j = std::floor(at.y());
  if (!(i >= 0.0 && j >= 0.0 && i < raster_.lines && j < raster_.lines)) return -1;
  return static_cast<int>(j) * raster_.lines + static_cast<int>(i);
}

void Overlay::drop_passing() {
  bool overlap = false;
  for (std::size_t k = 0; k < a_.size() && !overlap; ++k) overlap = is_met(k) && depth(k) > 0.0;
  if (!overlap) return;
  // The way into A below, and out of B above.
  std::vector<Hit> below(a_.size()), above(a_.size());
  pass(sheet_a_, Keep::highest_in_below, a_, below);
  pass(sheet_b_, Keep::lowest_out_above, b_, above);
  for (std::size_t k = 0; k < a_.size(); ++k)
    if (is_met(k) && depth(k) > 0.0 && below[k].part >= 0 && above[k].part >= 0 &&
        above[k].height <= below[k].height)
      a_[k].part = b_[k].part = -1;
}

void Overlay::pass(const Sheet& sheet, Keep keep, const std::vector<Hit>& bound,
                   std::vector<Hit>& hits) const {
  const auto steps = static_cast<std::size_t>(sheet.steps), row = steps + 1;
  std::vector<Vec3> seen(sheet.points_a_part());
  for (std::size_t k = 0; k < sheet.parts.size(); ++k) {
    const Vec3* points = sheet.points.data() + k * sheet.points_a_part();
    Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (std::size_t m = 0; m < seen.size(); ++m) {
      seen[m] = axes_.seen(points[m]);
      low = low.cwiseMin(seen[m].head<2>());
      high = high.cwiseMax(seen[m].head<2>());
    }
    const Vec2 end = raster_.low + raster_.lines * raster_.step;
    if (high.x() < raster_.low.x() || high.y() < raster_.low.y() || low.x() > end.x() || low.y() > end.y())
      continue;
    const bool inward = model_.face_of(model_.cells()[sheet.parts[k].cell]).inward;
    const double share = 1.0 / static_cast<double>(steps);
    for (std::size_t j = 0; j < steps; ++j)
      for (std::size_t i = 0; i < steps; ++i) {
        const std::size_t c = j * row + i;
        const Vec2 at(static_cast<double>(i) * share, static_cast<double>(j) * share);
        const Vec2 du(share, 0.0), dv(0.0, share);
        // Corners counter-clockwise seen from outside.
        if (inward) {
          pass({seen[c], seen[c + row + 1], seen[c + 1]}, {at, at + du + dv, at + du},
               static_cast<std::int32_t>(k), keep, bound, hits);
          pass({seen[c], seen[c + row], seen[c + row + 1]}, {at, at + dv, at + du + dv},
               static_cast<std::int32_t>(k), keep, bound, hits);
        } else {
          pass({seen[c], seen[c + 1], seen[c + row + 1]}, {at, at + du, at + du + dv},
               static_cast<std::int32_t>(k), keep, bound, hits);
          pass({seen[c], seen[c + row + 1], seen[c + row]}, {at, at + du + dv, at + dv},
               static_cast<std::int32_t>(k), keep, bound, hits);
        }
      }
  }
}

void Overlay::pass(const std::array<Vec3, 3>& seen, const std::array<Vec2, 3>& places, std::int32_t part,
                   Keep keep, const std::vector<Hit>& bound, std::vector<Hit>& hits) const {
  const bool out = keep == Keep::highest_out || keep == Keep::lowest_out_above;
  const bool highest = keep == Keep::highest_out || keep == Keep::highest_in_below;
  const Vec2 e1 = (seen[1] - seen[0]).head<2>(), e2 = (seen[2] - seen[0]).head<2>();
  const double size = cross(e1, e2);
  if (out ? !(size > 0.0) : !(size < 0.0)) return;
  const auto [x0, x1] = std::minmax({seen[0].x(), seen[1].x(), seen[2].x()});
  const auto [y0, y1] = std::minmax({seen[0].y(), seen[1].y(), seen[2].y()});
  const int i0 = raster_.first(0, x0), i1 = raster_.last(0, x1), j0 = raster_.first(1, y0),
            j1 = raster_.last(1, y1);
  // A little beyond the edges, so that no line slips between two triangles.
  constexpr double slack = -1e-9;
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i) {
      const Vec2 way = raster_.place(i, j) - seen[0].head<2>();
      const double w1 = cross(way, e2) / size, w2 = cross(e1, way) / size, w0 = 1.0 - w1 - w2;
      if (w0 < slack || w1 < slack || w2 < slack) continue;
      const double height = w0 * seen[0].z() + w1 * seen[1].z() + w2 * seen[2].z();
      Hit& hit = hits[raster_.number_of(i, j)];
      if (hit.part >= 0 && (highest ? height <= hit.height : height >= hit.height)) continue;
      if (!bound.empty()) {
        const Hit& end = bound[raster_.number_of(i, j)];
        if (end.part < 0 || (highest ? height >= end.height : height <= end.height)) continue;
      }
      const Vec2 place = w0 * places[0] + w1 * places[1] + w2 * places[2];
      hit = {height, part, static_cast<float>(place.x()), static_cast<float>(place.y())};
    }
}

Overlay::Place Overlay::place(const Hit& hit, const Sheet& sheet, std::size_t line) const {
  const Part& part = sheet.parts[static_cast<std::size_t>(hit.part)];
  const Vec2 share(std::clamp(static_cast<double>(hit.s), 0.0, 1.0),
                   std::clamp(static_cast<double>(hit.t), 0.0, 1.0));
  return {part.cell, part.low + (part.high - part.low).cwiseProduct(share),
          axes_.placed(centre(line), hit.height)};
}

bool Overlay::is_peak(std::size_t line) const {
  return raster_.all_about(line, 1, [&](std::size_t other) {
    return !is_met(other) || depth(other) < depth(line) || (depth(other) == depth(line) && other >= line);
  });
}

std::vector<int> Overlay::regions(double least_depth, int& count) const {
  std::vector<int> label(size(), -1);
  std::vector<std::size_t> stack;
  count = 0;
  const auto in = [&](std::size_t k) { return is_met(k) && depth(k) > least_depth && label[k] < 0; };
  for (std::size_t k = 0; k < size(); ++k) {
    if (!in(k)) continue;
    label[k] = count;
    stack.push_back(k);
    while (!stack.empty()) {
      const std::size_t here = stack.back();
      stack.pop_back();
      raster_.all_about(here, 1, [&](std::size_t other) {
        if (!in(other)) return true;
        label[other] = count;
        stack.push_back(other);
        return true;
      });
    }
    ++count;
  }
  return label;
}

std::vector<Part> Overlay::parts_about(std::size_t line, int radius, bool of_a) const {
  const Sheet& sheet = of_a ? sheet_a_ : sheet_b_;
  const std::vector<Hit>& hits = of_a ? a_ : b_;
  std::map<std::int32_t, Rectangle> ranges;
  raster_.all_about(line, radius, [&](std::size_t k) {
    if (hits[k].part >= 0) ranges[hits[k].part].extend(Vec2(hits[k].s, hits[k].t));
    return true;
  });
  std::vector<Part> parts;
  const double more = 1.0 / sheet.steps;
  for (const auto& [k, range] : ranges) {
    const Part& whole = sheet.parts[static_cast<std::size_t>(k)];
    const Vec2 low = (range.min() - Vec2::Constant(more)).cwiseMax(0.0),
               high = (range.max() + Vec2::Constant(more)).cwiseMin(1.0);
    parts.push_back({whole.cell, whole.low + (whole.high - whole.low).cwiseProduct(low),
                     whole.low + (whole.high - whole.low).cwiseProduct(high)});
  }
  return parts;
}

namespace {

constexpr int close_lines = 24, close_steps = 8, close_rounds = 5;

}  // namespace

bool Overlay::is_smooth_about(std::size_t line, int radius, bool of_a) const {
  std::optional<Vec3> first;
  return raster_.all_about(line, radius, [&](std::size_t k) {
    // Where the sheet ends there is an edge.
    if ((of_a ? a_ : b_)[k].part < 0) return false;
    const Place here = of_a ? on_a(k) : on_b(k);
    const Vec3 normal = point_at(model_.face_of(model_.cells()[here.cell]), here.site).normal;
    if (!first) first = normal;
    return first->dot(normal) > 0.99;
  });
}

std::optional<Deepest> close_in(const CellModel& model, std::vector<Part> parts_a, std::vector<Part> parts_b,
                                const Vec3& n, const Vec3& start, double reach, double slack) {
  std::optional<Deepest> best;
  const Axes axes(n, {start, start + reach * n.unitOrthogonal()});
  Vec2 centre = axes.seen(start).head<2>(), half = Vec2::Constant(reach);
  double error = slack;  // of these quads; they are at most half as long in the next round
  for (int round = 0; round < close_rounds; ++round, error *= 0.25) {
    const Sheet a(model, std::move(parts_a), close_steps), b(model, std::move(parts_b), close_steps);
    const Overlay overlay(model, a, b, axes, Rectangle(Vec2(centre - half), Vec2(centre + half)),
                          close_lines);
    std::optional<std::size_t> deepest;
    for (std::size_t k = 0; k < overlay.size(); ++k)
      if (overlay.is_met(k) && (!deepest || overlay.depth(k) > overlay.depth(*deepest))) deepest = k;
    if (!deepest) break;
    best = Deepest{overlay.on_a(*deepest), overlay.on_b(*deepest), overlay.depth(*deepest)};
    if (best->depth < -error - overlay.step().maxCoeff()) break;
    best->smooth_a = overlay.is_smooth_about(*deepest, 2, true);
    best->smooth_b = overlay.is_smooth_about(*deepest, 2, false);
    parts_a = overlay.parts_about(*deepest, 2, true);
    parts_b = overlay.parts_about(*deepest, 2, false);
    centre = overlay.centre(*deepest);
    half = 2.0 * overlay.step();
  }
  return best;
}

}  // namespace selvage::contact
