#include "braid/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <vector>

#include "fabric/clearance.h"
#include "nurbs/roots.h"

namespace selvage::fabric {

Run run_of(const BraidShape& shape, std::int64_t k) {
  const std::int64_t period = std::int64_t{shape.over} + shape.under;
  const std::int64_t base = k / 2 * period + (shape.flat ? 1 : 0);
  Run run = k % 2 == 0 ? Run{base, base + shape.over - 1} : Run{base + shape.over, base + period - 1};
  if (shape.flat) run.last = std::min<std::int64_t>(run.last, shape.carriers - 1);
  return run;
}

std::int64_t run_count(const BraidShape& shape) {
  const std::int64_t period = std::int64_t{shape.over} + shape.under;
  const std::int64_t columns = shape.flat ? shape.carriers - 1 : shape.carriers;
  const std::int64_t rest = columns % period;
  return columns / period * 2 + (rest > 0 ? 1 : 0) + (rest > shape.over ? 1 : 0);
}

namespace {

// The braiders that cross at a column, as at crossing number `column` of the first and of the second: on a
// strip those on the way there and back.
std::array<Braider, 2> braiders_at(const BraidShape& shape, std::int64_t column) {
  if (shape.flat) return {Braider{0, 1}, Braider{2 * (std::int64_t{shape.carriers} - column), 1}};
  return {Braider{0, 1}, Braider{2 * column, -1}};
}

SweptYarn swept(const BraidShape& shape, const Braider& braider, const std::vector<Vec2>& outline) {
  return {[&shape, braider](double t) {
            const BraidPoint point = braid_point(shape, braider, t);
            const Vec3 tangent = point.derivative.normalized();
            const Vec3 out = shape.flat || shape.planar
                                 ? Vec3(Vec3::UnitZ())
                                 : Vec3(point.position.x(), point.position.y(), 0.0).normalized();
            const Vec3 up = (out - out.dot(tangent) * tangent).normalized();
            return SweptStation{point.position, point.derivative, up.cross(tangent), up};
          },
          outline};
}

// An axial yarn in the middle of a run, by the same parameter.
SweptYarn swept_axial(const BraidShape& shape, const Run& run, const std::vector<Vec2>& outline) {
  const double middle = run.middle(), turn = 2.0 * std::numbers::pi / shape.carriers * middle;
  return {[&shape, middle, turn](double t) {
            const double along = (t + 0.5) * shape.step;
            const double y =
                shape.planar ? shape.level_place(middle) : shape.column * (middle - 0.5 * shape.carriers);
            if (shape.flat || shape.planar)
              return SweptStation{Vec3(along, y, 0.0), Vec3(shape.step, 0.0, 0.0), Vec3(0.0, -1.0, 0.0),
                                  Vec3(0.0, 0.0, 1.0)};
            const Vec3 out(std::cos(turn), std::sin(turn), 0.0), along_axis(0.0, 0.0, shape.step);
            return SweptStation{shape.radius * out + Vec3(0.0, 0.0, along), along_axis,
                                out.cross(Vec3(0.0, 0.0, 1.0)), out};
          },
          outline};
}

// The columns at which braiders meet in different ways: by who is on top here and at the neighbours.
std::vector<std::int64_t> different_columns(const BraidShape& shape) {
  std::set<std::array<int, 3>> known;
  std::vector<std::int64_t> columns;
  const auto look = [&](std::int64_t column) {
    std::array<int, 3> ways{};
    for (int i = 0; i < 3; ++i) {
      const std::int64_t c = column - 1 + i;
      const bool is_edge = shape.flat && (c < 1 || c >= shape.carriers);
      ways[static_cast<std::size_t>(i)] = is_edge ? 2 : static_cast<int>(shape.is_over(c));
    }
    if (known.insert(ways).second) columns.push_back(column);
  };
  // Within a run only its ends differ from its inside.
  const auto look_at_run = [&](const Run& run) {
    for (const std::int64_t column : {run.first, run.first + 1, run.last - 1, run.last})
      if (column >= run.first && column <= run.last) look(column);
  };
  const std::int64_t runs = run_count(shape);
  for (std::int64_t k = 0; k < std::min<std::int64_t>(runs, 4); ++k) look_at_run(run_of(shape, k));
  if (shape.flat) look_at_run(run_of(shape, runs - 1));
  return columns;
}

// Between these steps of its way.
struct Stretch {
  SweptYarn yarn;
  double from = 0, to = 0;
  [[nodiscard]] double middle() const { return 0.5 * (from + to); }
};

// Points of each against sections of the other: an edge of one shows in the other's flat side only from
// there.
double gap_of(const Stretch& a, const Stretch& b, int stations) {
  const double reach_a = 0.5 * (a.to - a.from) + 0.5, reach_b = 0.5 * (b.to - b.from) + 0.5;
  return std::min(refined_gap(a.yarn, a.from, a.to, stations, b.yarn, b.middle(), reach_b),
                  refined_gap(b.yarn, b.from, b.to, stations, a.yarn, a.middle(), reach_a));
}

// The least gap of all yarns that cross, with the shape's amplitude.
double crossing_gap(const BraidShape& shape, const std::vector<Vec2>& outline,
                    const std::vector<Vec2>& axial_outline) {
  constexpr int stations = 48;
  double gap = std::numeric_limits<double>::infinity();
  for (const std::int64_t column : different_columns(shape)) {
    const std::array<Braider, 2> pair = braiders_at(shape, column);
    const auto t = static_cast<double>(column);
    gap = std::min(gap, gap_of({swept(shape, pair[0], outline), t - 1.0, t + 1.0},
                               {swept(shape, pair[1], outline), t - 1.0, t + 1.0}, stations));
  }
  if (axial_outline.empty()) return gap;
  for (std::int64_t k = 0; k < std::min<std::int64_t>(run_count(shape), 2); ++k) {
    const Run run = run_of(shape, k);
    const std::array<Braider, 2> pair = braiders_at(shape, run.first);
    for (const Braider& braider : pair) {
      const bool forward = &braider == pair.data();
      const auto t = static_cast<double>(run.first), width = static_cast<double>(run.last - run.first);
      const double from = forward ? t - 1.0 : t - width - 1.0, to = forward ? t + width + 1.0 : t + 1.0;
      gap = std::min(gap, gap_of({swept(shape, braider, outline), from, to},
                                 {swept_axial(shape, run, axial_outline), from, to}, 2 * stations));
    }
  }
  return gap;
}

}  // namespace

double fit_amplitude(BraidShape& shape, double least, double wanted, const std::vector<Vec2>& outline,
                     const std::vector<Vec2>& axial_outline) {
  const auto gap_at = [&](double amplitude) {
    shape.amplitude = amplitude;
    return crossing_gap(shape, outline, axial_outline);
  };
  struct Try {
    double amplitude, gap;
  };
  std::vector<Try> tries;
  double low = least, high = least + 0.5 * wanted;
  constexpr double most = 2.5, growth = 1.12;
  while (true) {
    tries.push_back({high, gap_at(high)});
    if (tries.back().gap >= wanted || high > most * least) break;
    low = high;
    high *= growth;
  }
  if (tries.back().gap < wanted) {
    // A larger amplitude that brings nothing only makes the path steeper: the smallest one near the largest
    // gap.
    constexpr double enough = 0.05;  // of the least amplitude
    const double largest = std::ranges::max(tries, {}, &Try::gap).gap;
    const double below = largest - enough * least, near = largest < 0.0 ? below : std::max(below, 0.0);
    const auto chosen = std::ranges::find_if(tries, [&](const Try& tried) { return tried.gap >= near; });
    shape.amplitude = chosen->amplitude;
    return chosen->gap;
  }
  nurbs::halve_between(low, high, 10, [&](double middle) { return !(gap_at(middle) >= wanted); });
  return gap_at(high);
}

}  // namespace selvage::fabric
