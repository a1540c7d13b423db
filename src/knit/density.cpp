#include "knit/density.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>

#include "knit/knit_mend.h"
#include "nurbs/measure.h"

namespace selvage::fabric {

namespace {

constexpr double published_overlap = 3;  // of head and sinker beyond the line at which loops hold each other
constexpr double least_overlap = 1.2;    // in r: a head that just lies behind the legs of the next loop
constexpr double head_room = 2;          // in r: from a head to the line at which the next but one is held
constexpr double deepest = 3;            // loops that stand out of the cloth, of the published depth

constexpr double shortest = -1, longest = 2;

// The loops of the way, from the shortest to the longest; at 0 the published one between the field's
// spacings.
LoopShape shape_at(const LoopShape& spaced, double way) {
  LoopShape shape = spaced;
  // Yarns lie side by side where a head holds two feet, and need a thickness each.
  const double crowded = wale_spacing / spaced.wale;
  const double overlap = published_overlap * spaced.course / course_spacing;
  const double share = std::clamp(way, -1.0, 1.0);
  const auto between = [&](double least, double most) {
    return share < 0 ? 1 + share * (1 - std::min(least, 1.0)) : 1 + share * (std::max(most, 1.0) - 1);
  };
  shape.bulge = between(crowded, 2 - crowded);
  shape.overlap = between(least_overlap / overlap, (spaced.course - head_room) / overlap);
  shape.depth =
      spaced.depth + (0.25 * std::max(way, 0.0) + 0.75 * std::max(way - 1, 0.0)) * (deepest - 1) / 1.25;
  return shape;
}

}  // namespace

double stitch_length(const KnitField& field, nurbs::Parameterization how, const Vec2& half) {
  KnitField endless = field;
  const long long courses = field.chart.repeat_of_courses(), wales = field.chart.repeat_of_wales();
  const long long far = 2LL * max_held * field.chart.feeds();
  endless.first_course = endless.first_wale = -far;
  endless.last_course = courses + far;
  endless.last_wale = wales + far;
  const double r = half.x();
  const Vec3 period(static_cast<double>(wales) * field.shape.wale * r, 0, 0);
  double length = 0;
  long long stitches = 0;
  for (long long course = 0; course < courses; ++course) {
    std::vector<Vec3> points;
    for (long long wale = 0; wale < wales; ++wale) {
      std::size_t i = points.size();
      add_stitch_points(endless, course, wale, points);
      for (; i < points.size(); ++i)
        points[i] = {(points[i].x() + static_cast<double>(wale) * field.shape.wale) * r, points[i].y() * r,
                     points[i].z() * half.y()};
      if (field.chart.at(course, wale) != Stitch::miss) ++stitches;
    }
    points.push_back(points.front() + period);
    length += nurbs::arc_length(periodic_course(points, period, how));
  }
  return length / static_cast<double>(std::max(stitches, 1LL));
}

LengthBounds length_bounds(const KnitField& field, nurbs::Parameterization how, const Vec2& half) {
  KnitField tried = field;
  const auto length_at = [&](double way) {
    tried.shape = shape_at(field.shape, way);
    return stitch_length(tried, how, half);
  };
  return {length_at(shortest), length_at(longest)};
}

namespace {

// The nearest value to 1 (found by halving, to a hundredth) for which something holds that does not for 1.
std::optional<double> nearest_factor(double step, const std::function<bool(double)>& holds) {
  double without = 1, with = step;
  constexpr double farthest = 20, enough = 1.005;
  while (!holds(with)) {
    if (with > farthest || with < 1 / farthest) return std::nullopt;
    without = with;
    with *= step;
  }
  while (std::max(with / without, without / with) > enough) {
    const double middle = std::sqrt(with * without);
    (holds(middle) ? with : without) = middle;
  }
  return with;
}

Message out_of_bounds(const KnitField& field, nurbs::Parameterization how, const Vec2& half, double length,
                      const LengthBounds& bounds) {
  const bool is_short = length < bounds.least;
  const auto fits = [&](double spacing, double thickness) {
    KnitField tried = field;
    tried.shape.wale *= spacing / thickness;
    tried.shape.course *= spacing / thickness;
    const LengthBounds b = length_bounds(tried, how, thickness * half);
    return is_short ? length >= b.least : length <= b.most;
  };
  std::string text =
      fmt::format("loops of {:.6g} are too {} for these courses and wales: {} {:.4g} at {}", length,
                  is_short ? "short" : "long", is_short ? "with this yarn they have" : "they fold; they have",
                  is_short ? bounds.least : bounds.most, is_short ? "least" : "most");
  const double r = half.x();
  if (const auto spacing = nearest_factor(is_short ? 0.8 : 1.25, [&](double f) { return fits(f, 1); }))
    text += fmt::format(", or with courses {:.3g} and wales {:.3g} apart take {:.6g}",
                        field.shape.course * r * *spacing, field.shape.wale * r * *spacing, length);
  if (const auto thickness = nearest_factor(is_short ? 0.8 : 1.25, [&](double f) { return fits(1, f); }))
    text +=
        fmt::format(", and so they do with a yarn of {:.3g} instead of {:.3g}", 2 * r * *thickness, 2 * r);
  return error(Kind::geometry, std::move(text));
}

}  // namespace

Result<LoopShape> shape_of_length(const KnitField& field, nurbs::Parameterization how, const Vec2& half,
                                  double length) {
  KnitField tried = field;
  const auto excess = [&](double way) {
    tried.shape = shape_at(field.shape, way);
    return stitch_length(tried, how, half) - length;
  };
  double low = shortest, high = longest, below = excess(low), above = excess(high);
  if (below > 0 || above < 0)
    return out_of_bounds(field, how, half, length, {below + length, above + length});
  // The method of Illinois: regula falsi that halves what stands at an end for twice.
  constexpr double enough = 1e-9;
  constexpr int most = 100;
  int last = 0;
  for (int i = 0; i < most; ++i) {
    const double way = (low * above - high * below) / (above - below), now = excess(way);
    if (std::abs(now) <= enough * length) break;
    const int side = now < 0 ? -1 : 1;
    (side < 0 ? low : high) = way;
    (side < 0 ? below : above) = now;
    if (side == last) (side < 0 ? above : below) *= 0.5;
    last = side;
  }
  return tried.shape;
}

}  // namespace selvage::fabric
