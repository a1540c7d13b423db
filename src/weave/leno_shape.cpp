#include "weave/leno_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace selvage::fabric {

namespace {

using std::numbers::pi;

SweptYarn swept_end(const LenoShape& shape, bool is_doup, const std::vector<Vec2>& outline) {
  return {[&shape, is_doup](double t) {
            const LenoPoint point = leno_point(shape, is_doup, t);
            const Vec3 tangent = point.derivative.normalized();
            const Vec3 up = (Vec3::UnitZ() - tangent.z() * tangent).normalized();
            return SweptStation{point.position, point.derivative, up.cross(tangent), up};
          },
          outline};
}

// Number 0, by its y.
SweptYarn swept_pick(const LenoShape& shape, const std::vector<Vec2>& outline) {
  return {[&shape](double y) {
            return SweptStation{Vec3(0.5 * shape.pick, y, 0.0), Vec3(0.0, 1.0, 0.0), Vec3(-1.0, 0.0, 0.0),
                                Vec3(0.0, 0.0, 1.0)};
          },
          outline};
}

}  // namespace

LenoPoint leno_point(const LenoShape& shape, bool is_doup, double t) {
  const double on_pick = is_doup ? shape.over : -shape.under;
  const double between = is_doup ? -shape.crossing : shape.crossing;
  const double middle = 0.5 * (on_pick + between), wave = 0.5 * (on_pick - between);
  const double turn = 2.0 * pi * t;
  LenoPoint point{Vec3((t + 0.5) * shape.pick, 0.0, middle + wave * std::cos(turn)),
                  Vec3(shape.pick, 0.0, -2.0 * pi * wave * std::sin(turn))};
  if (!is_doup) return point;
  if (shape.full) {
    point.position.y() = -shape.side * std::sin(turn);
    point.derivative.y() = -2.0 * pi * shape.side * std::cos(turn);
  } else {
    point.position.y() = -shape.side * std::cos(0.5 * turn);
    point.derivative.y() = pi * shape.side * std::sin(0.5 * turn);
  }
  return point;
}

// By differences of the slopes: the second derivative of waves.
double tightest_bend(const LenoShape& shape, bool is_doup, double height) {
  constexpr int looks = 256;
  constexpr double step = 1e-4;
  double tightest = 0.0;
  for (int i = 0; i <= looks; ++i) {
    const double t = 2.0 * i / looks;
    const Vec3 first = leno_point(shape, is_doup, t).derivative;
    const Vec3 second =
        (leno_point(shape, is_doup, t + step).derivative - leno_point(shape, is_doup, t - step).derivative) /
        (2.0 * step);
    tightest = std::max(tightest, 0.5 * height * first.cross(second).norm() / std::pow(first.norm(), 3));
  }
  return tightest;
}

double fit_leno(LenoShape& shape, double wanted, const LenoYarn& standing, const LenoYarn& doup,
                const LenoYarn& pick) {
  constexpr double growth = 1.02;
  constexpr int most_steps = 120, stations = 64;
  shape.over = 0.5 * (pick.height + doup.height) + wanted;
  shape.under = 0.5 * (pick.height + standing.height) + wanted;
  shape.crossing = 0.25 * (standing.height + doup.height) + 0.5 * wanted;
  shape.side = 0.25 * (standing.width + doup.width);
  double gap = 0.0;
  for (int step = 0; step < most_steps; ++step) {
    const SweptYarn over = swept_end(shape, true, doup.outline),
                    under = swept_end(shape, false, standing.outline);
    const SweptYarn across = swept_pick(shape, pick.outline);
    const double reach = 2.0 * (doup.width + standing.width) + shape.side;
    const double above = least_gap(over, -0.5, 0.5, stations, across, 0.0, reach);
    const double below = least_gap(under, -0.5, 0.5, stations, across, 0.0, reach);
    const double round = std::min(least_gap(over, 0.0, 1.0, stations, under, 0.5, 1.0),
                                  least_gap(under, 0.0, 1.0, stations, over, 0.5, 1.0));
    gap = std::min({above, below, round});
    if (gap >= wanted) break;
    if (above < wanted) shape.over *= growth;
    if (below < wanted) shape.under *= growth;
    if (round < wanted) {
      shape.side *= growth;
      shape.crossing *= std::sqrt(growth);
    }
  }
  return gap;
}

}  // namespace selvage::fabric
