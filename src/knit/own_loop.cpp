#include "knit/own_loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <tuple>

#include "core/wrapped.h"
#include "knit/knit_mend.h"
#include "nurbs/basis.h"
#include "nurbs/spline.h"

namespace selvage::fabric {

namespace {

using Polyline = std::vector<Vec3>;

double cross_of(const Vec3& a, const Vec3& b) {
  return a.x() * b.y() - a.y() * b.x();
}

const OwnLoop* find_own(const Knit& knit, char sign) {
  const auto found = std::find_if(knit.own_loops.begin(), knit.own_loops.end(),
                                  [&](const OwnLoop& loop) { return loop.sign == sign; });
  return found == knit.own_loops.end() ? nullptr : &*found;
}

Message at(const OwnLoop& loop, std::string text) {
  return error(Kind::geometry, std::move(text)).placed(loop.place);
}

// The centre lines of one row's stitches, over one repeat of wales.
std::vector<Polyline> stitches_of(const KnitField& field, nurbs::Parameterization how, long long row) {
  constexpr int looks = 8;  // from point to point
  const long long wales = field.chart.repeat_of_wales();
  std::vector<Vec3> points;
  std::vector<std::size_t> first;
  for (long long wale = 0; wale < wales; ++wale) {
    first.push_back(points.size());
    add_stitch_points(field, row, wale, points);
    for (std::size_t i = first.back(); i < points.size(); ++i)
      points[i].x() += static_cast<double>(wale) * field.shape.wale;
  }
  first.push_back(points.size());
  const Vec3 period(static_cast<double>(wales) * field.shape.wale, 0, 0);
  points.push_back(points.front() + period);
  const nurbs::Curve curve = periodic_course(points, period, how);
  const std::vector<double> breaks = nurbs::breakpoints(curve.knots, curve.degree);
  std::vector<Polyline> stitches;
  for (std::size_t wale = 0; wale + 1 < first.size(); ++wale) {
    Polyline& stitch = stitches.emplace_back();
    for (std::size_t span = first[wale]; span < first[wale + 1]; ++span)
      for (int i = 0; i < looks; ++i)
        stitch.push_back(
            nurbs::evaluate(curve, breaks[span] + (breaks[span + 1] - breaks[span]) * i / looks));
    stitch.push_back(nurbs::evaluate(curve, breaks[first[wale + 1]]));
    const double height = field.chart.height(row) * field.shape.course;
    for (Vec3& p : stitch) p += Vec3(-static_cast<double>(wale) * field.shape.wale, height, 0);
  }
  return stitches;
}

Status check_closing(const Knit& knit, const KnitField& field) {
  constexpr double same = 1e-6;  // of a wale, a course, a thickness
  for (long long row = 0; row < field.chart.repeat_of_courses(); ++row)
    for (long long wale = 0; wale < field.chart.repeat_of_wales(); ++wale) {
      const OwnLoop &own = *find_own(knit, static_cast<char>(field.chart.at(row, wale))),
                    &next = *find_own(knit, static_cast<char>(field.chart.at(row, wale + 1)));
      const Vec3 end = own.points.back() - Vec3::UnitX(), &begin = next.points.front();
      if ((end - begin).norm() <= same) continue;
      return at(
          own,
          fmt::format("{} does not close onto the {} on its right: it ends in {} {} {}, and one wale on that "
                      "begins in {} {} {}: end it in {} {} {}",
                      own.sign, next.sign, own.points.back().x(), end.y(), end.z(), begin.x() + 1, begin.y(),
                      begin.z(), begin.x() + 1, begin.y(), begin.z()));
    }
  return {};
}

}  // namespace

int passages(const std::vector<Vec3>& loop, const std::vector<Vec3>& line) {
  Vec3 middle = Vec3::Zero();
  double area = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    middle += loop[i] / static_cast<double>(loop.size());
    area += cross_of(loop[i], loop[(i + 1) % loop.size()]);
  }
  const int sense = area < 0 ? -1 : 1;  // clockwise seen from the face: -1
  int count = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3 a = loop[i] - middle, b = loop[(i + 1) % loop.size()] - middle, normal = a.cross(b);
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
      const Vec3 start = line[k] - middle, way = line[k + 1] - line[k];
      const double rise = normal.dot(way);
      if (rise == 0) continue;
      const double on_line = -normal.dot(start) / rise;
      const Vec3 hit = start + on_line * way;
      const double on_a = normal.dot(hit.cross(b)), on_b = normal.dot(a.cross(hit)),
                   both = normal.squaredNorm();
      if (on_line < 0 || on_line >= 1 || on_a < 0 || on_b < 0 || on_a + on_b >= both) continue;
      count += rise > 0 ? sense : -sense;
    }
  }
  return count;
}

bool interloops(const std::vector<Vec3>& held, const std::vector<Vec3>& loop, double side) {
  const auto head =
      std::max_element(loop.begin(), loop.end(), [](const Vec3& a, const Vec3& b) { return a.y() < b.y(); });
  const int forward = side > 0 ? 1 : -1;
  return passages(held, {loop.begin(), head + 1}) == forward &&
         passages(held, {head, loop.end()}) == -forward;
}

Status check_own_loops(const Knit& knit, const KnitField& field) {
  const StitchChart& chart = field.chart;
  const long long rows = chart.repeat_of_courses(), wales = chart.repeat_of_wales();
  for (long long row = 0; row < rows; ++row)
    for (long long wale = 0; wale < wales; ++wale)
      if (const auto sign = static_cast<char>(chart.at(row, wale)); find_own(knit, sign) == nullptr)
        return at(
            knit.own_loops.front(),
            fmt::format("the chart has a {0}, whose points are not given: add a block 'points {0}'", sign));
  if (Status closes = check_closing(knit, field); !closes) return closes;
  const auto how = method_of(knit);
  KnitField endless = field;
  const long long far = static_cast<long long>(max_held + 1) * chart.feeds();
  endless.first_course = -far;
  endless.last_course = rows + far;
  // Each stitch with what its needle holds: alike in many places.
  std::set<std::tuple<Stitch, Stitch, long long>> seen;
  for (long long row = 0; row < rows; ++row)
    for (long long wale = 0; wale < wales; ++wale) {
      const Stitch stitch = chart.at(row, wale);
      if (!is_loop(stitch)) continue;
      const long long held = held_course(endless, row, wale, bed_of(stitch));
      if (held < endless.first_course) continue;
      const int bed = bed_of(stitch);
      if (!seen.emplace(stitch, chart.at(held, wale, bed), row - held).second) continue;
      const auto of_wale = static_cast<std::size_t>(wale);
      const double side = stitch == Stitch::knit ? 1 : -1;
      if (interloops(stitches_of(endless, how, held)[of_wale], stitches_of(endless, how, row)[of_wale], side))
        continue;
      const OwnLoop& own = *find_own(knit, static_cast<char>(stitch));
      return at(
          own,
          fmt::format("courses do not interloop: {} does not go through the {} below it from {} and back on "
                      "both sides of its head (wale {}, course {} of the chart)",
                      own.sign, static_cast<char>(chart.at(held, wale, bed)),
                      side > 0 ? "the back to the face" : "the face to the back", wale + 1,
                      row / chart.feeds() + 1));
    }
  return {};
}

namespace {

// The loop path of a bar over some courses, by its stitches.
class BarStitches {
 public:
  BarStitches(YarnPoints points, long long first) : points_(std::move(points)), first_(first) {
    yarn::PathRows rows;
    rows.form = yarn::PathForm::control;
    rows.points = yarn::loop_control_points(points_.of_guide(0), false);
    if (const Result<yarn::CentreLine> line = yarn::make_centre_line(rows); line) curve_ = line->curve;
    breaks_ = nurbs::breakpoints(curve_.knots, curve_.degree);
  }
  [[nodiscard]] Polyline at(long long course, double x) const {
    constexpr int looks = 8;  // from row to row
    const auto [from, to] = points_.stitches()[static_cast<std::size_t>(course - first_)];
    Polyline stitch;
    for (std::size_t i = 0; i <= looks * (to - from); ++i) {
      // Row k lies between the control points 2 k - 1 and 2 k.
      const double place = 2 * (static_cast<double>(from) + static_cast<double>(i) / looks) - 1.5;
      const auto span = static_cast<std::size_t>(place);
      const double share = place - static_cast<double>(span);
      stitch.push_back(nurbs::evaluate(curve_, breaks_[span] + share * (breaks_[span + 1] - breaks_[span])));
      stitch.back().x() += x;
    }
    return stitch;
  }

 private:
  YarnPoints points_;
  long long first_;
  nurbs::Curve curve_;
  std::vector<double> breaks_;
};

bool forms_loop(const Bar& bar, long long course) {
  return !bar.is_fall_plate && !overlap_at(bar.lapping, course).is_laid_in();
}

}  // namespace

Status check_own_loops(const std::vector<Bar>& bars, const Measures& measures) {
  if (std::none_of(bars.begin(), bars.end(), [](const Bar& bar) { return bar.own != nullptr; })) return {};
  constexpr long long most_courses = 200;
  long long courses = 1;
  for (const Bar& bar : bars)
    courses = std::min(most_courses, std::lcm(courses, static_cast<long long>(bar.lapping.size())));
  const long long first = -longest_hold - 1;
  const LoopMoves none;
  std::vector<BarStitches> stitches;
  for (std::size_t b = 0; b < bars.size(); ++b) {
    Result<YarnPoints> points = points_of_bar(bars, b, measures, none, first, courses + 1);
    if (!points) return points.error();
    stitches.emplace_back(std::move(*points), first);
  }
  for (long long course = 0; course < courses; ++course)
    for (std::size_t upper = 0; upper < bars.size(); ++upper) {
      if (!forms_loop(bars[upper], course)) continue;
      long long held = course - 1;
      const auto knits = [&](const Bar& bar) { return forms_loop(bar, held); };
      while (held > first && std::none_of(bars.begin(), bars.end(), knits)) --held;
      for (std::size_t lower = 0; lower < bars.size(); ++lower) {
        const OwnLoop* own = bars[upper].own != nullptr ? bars[upper].own : bars[lower].own;
        if (own == nullptr || !forms_loop(bars[lower], held)) continue;
        if (bars[lower].own != nullptr && course - held > 1)
          return at(*own, fmt::format(
                              "a loop of given points ends one course on; that of bar {} in course {} of its "
                              "lapping is held for {}: leave out its 'points'",
                              lower + 1, wrapped(held, courses) + 1, course - held));
        const double x = measures.wale_pitch * (overlap_at(bars[upper].lapping, course).needle() -
                                                overlap_at(bars[lower].lapping, held).needle());
        if (interloops(stitches[lower].at(held, x), stitches[upper].at(course, 0), 1)) continue;
        return at(
            *own,
            fmt::format("courses do not interloop: the loop of bar {} in course {} of the lappings does not "
                        "go through that of bar {} below it from the back to the face and back on both "
                        "sides of its head",
                        upper + 1, course + 1, lower + 1));
      }
    }
  return {};
}

}  // namespace selvage::fabric
