// The draft `leno` of a weave: leno.h says where its yarns lie.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/wrapped.h"
#include "fabric/clearance.h"
#include "nurbs/interpolate.h"
#include "weave/construction.h"

namespace selvage::fabric {

namespace {

constexpr int points_a_pick = 24;
constexpr double most_warp_bend = 0.95;  // of half the thickness to the bend's radius
// A pitch of picks that has room is looked for in these steps.
constexpr double pick_growth = 1.02;
constexpr int most_pick_steps = 150;

bool is_doup(long long warp) {
  return wrapped<long long>(warp, 2) == 1;
}

// The thickest of the threads that `takes` picks out, by their place in the list.
template <class Takes>
LenoYarn thickest_of(const System& system, const Takes& takes) {
  LenoYarn thickest;
  for (long long yarn = 0; yarn < 2 * static_cast<long long>(system.threads.size()); ++yarn) {
    const WovenThread& thread = system.thread(yarn);
    if (!takes(yarn) || thread.size.height <= thickest.height) continue;
    thickest = {outline_polygon(thread.section), thread.size.width, thread.size.height};
  }
  return thickest;
}

}  // namespace

Status WeaveConstruction::prepare_leno() {
  drawdown_ = *drawdown_of(weave_.draft);
  LenoShape shape;
  shape.full = weave_.draft.full_turns;
  shape.pick = weft_.text->pitch;
  const LenoYarn standing = thickest_of(warp_, [](long long warp) { return !is_doup(warp); });
  const LenoYarn doup = thickest_of(warp_, is_doup);
  const LenoYarn pick = thickest_of(weft_, [](long long) { return true; });
  const std::string_view unit = name_of(fabric_.units);
  const auto fits = [&] {
    return fit_leno(shape, clearance_, standing, doup, pick) >= 0.5 * clearance_ &&
           tightest_bend(shape, false, standing.height) < most_warp_bend &&
           tightest_bend(shape, true, doup.height) < most_warp_bend;
  };
  if (!fits()) {
    const auto fits_at = [&](int steps) {
      shape.pick = weft_.text->pitch * std::pow(pick_growth, steps);
      return fits();
    };
    // A number of steps with too little room, and one with room; then the least.
    int close = 0, wide = 1;
    while (wide < most_pick_steps && !fits_at(wide)) {
      close = wide;
      wide = std::min(2 * wide, most_pick_steps);
    }
    while (wide - close > 1) {
      const int middle = (close + wide) / 2;
      (fits_at(middle) ? wide : close) = middle;
    }
    shape.pick = weft_.text->pitch * std::pow(pick_growth, wide);
    return error(Kind::geometry,
                 fmt::format(
                     "the ends of a pair have no room to cross between picks {:.4g} {} apart: they pass each "
                     "other, and bend no more tightly than they are thick, at a pitch of {:.4g} {} or more",
                     weft_.text->pitch, unit, shape.pick, unit))
        .placed(weft_.text->place);
  }
  const double room = 2.0 * warp_.text->pitch,
               needed = shape.side + 0.5 * (standing.width + doup.width) + clearance_;
  if (room < needed)
    return error(Kind::geometry,
                 fmt::format("pairs of warps have no room beside each other: at a pitch of {:.4g} {} a "
                             "pair has {:.4g}, and needs {:.4g}; the pitch has to be {:.4g} {} at least",
                             warp_.text->pitch, unit, room, needed, 0.5 * needed, unit))
        .placed(warp_.text->place);
  leno_ = shape;
  add_block(Block::Kind::warp, 0, 0, row_of(warp_));
  add_block(Block::Kind::weft, 0, 0, row_of(weft_));
  return {};
}

Status WeaveConstruction::plan_leno(YarnPlan& plan, bool is_weft, long long yarn) const {
  const Reach& reach = is_weft ? along_y_ : along_x_;
  plan.spec.guide = yarn::FrameGuide::with_up(Vec3::UnitZ());
  if (is_weft) {
    plan.at = along_weft(0.0, 0.0, weft_.at(static_cast<double>(yarn)));
    for (const double s : {reach.from, reach.to}) plan.points.push_back(along_weft(s, 0.0, 0.0));
    return interpolate(plan, yarn::PathForm::chord, Vec3::UnitY(), Vec3::UnitY());
  }
  // Both ends of a pair stand about its middle.
  const auto first = static_cast<double>(yarn - wrapped<long long>(yarn, 2));
  plan.at = along_warp(0.0, 0.0, warp_.at(first + 0.5));
  const bool doup = is_doup(yarn);
  const long long steps = (reach.last - reach.first + 1) * points_a_pick;
  std::vector<double> parameters;
  for (long long k = 0; k <= steps; ++k) {
    const double t = static_cast<double>(reach.first) - 0.5 + static_cast<double>(k) / points_a_pick;
    plan.points.push_back(leno_point(*leno_, doup, t).position);
    parameters.push_back(static_cast<double>(k) / static_cast<double>(steps));
  }
  const double picks = static_cast<double>(reach.last - reach.first + 1);
  const auto derivative = [&](double t) { return Vec3(picks * leno_point(*leno_, doup, t).derivative); };
  plan.line.curve =
      nurbs::interpolate(plan.points, parameters, derivative(static_cast<double>(reach.first) - 0.5),
                         derivative(static_cast<double>(reach.last) + 0.5));
  plan.line.parameters = std::move(parameters);
  return {};
}

}  // namespace selvage::fabric
