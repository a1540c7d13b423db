#include "fabric/knit_density.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fabric/knit_mend.h"
#include "nurbs/measure.h"

namespace selvage::fabric {

namespace {

constexpr double published_overlap = 3;  // of head and sinker beyond the line at which loops hold each other
constexpr double least_overlap = 1.2;    // in r: a head that just lies behind the legs of the next loop
constexpr double deepest = 2;            // loops that stand out of the cloth, of the published depth

// The loops of the way, -1 ... 2; at 0 the published one between the field's spacings.
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
  shape.overlap = between(least_overlap / overlap, (spaced.course - 1) / overlap);
  shape.depth = 1 + std::max(way - 1, 0.0) * (deepest - 1);
  return shape;
}

}  // namespace

double stitch_length(const KnitField& field, nurbs::Parameterization how, const Vec2& half) {
  KnitField endless = field;
  const long long courses = field.chart.repeat_of_courses(), wales = field.chart.repeat_of_wales();
  constexpr long long far = 4LL * max_held;
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

Result<LoopShape> shape_of_length(const KnitField& field, nurbs::Parameterization how, const Vec2& half,
                                  double length) {
  KnitField tried = field;
  const auto excess = [&](double way) {
    tried.shape = shape_at(field.shape, way);
    return stitch_length(tried, how, half) - length;
  };
  double low = -1, high = 2, below = excess(low), above = excess(high);
  if (below > 0 || above < 0)
    return error(Kind::geometry,
                 fmt::format("loops of {:.6g} are too {} for these courses and wales: with this yarn they "
                             "can have {:.4g} to {:.4g}",
                             length, below > 0 ? "short" : "long", below + length, above + length));
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
