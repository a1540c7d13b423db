#include "fabric/woven_cloth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/wrapped.h"
#include "fabric/yarn_kind.h"
#include "nurbs/restrict.h"

namespace selvage::fabric {

namespace {

using mechanics::WovenSystem;

constexpr double stiffness_of_solids = 100;

Weave::State state_of(const Weave& weave) {
  return weave.state.value_or(Weave::State::finished);
}

WovenSystem system_of(bool is_weft) {
  return is_weft ? WovenSystem::weft : WovenSystem::warp;
}

// A thread of the text as a yarn of the mechanics, lengths in file units.
Result<mechanics::WovenYarn> woven_yarn(const WovenThread& woven, Unit units, bool is_warp,
                                        const mechanics::WovenConstants& constants) {
  const Thread& thread = *woven.thread;
  mechanics::WovenYarn made;
  const Result<std::optional<double>> twist = twist_factor_of(thread, units, is_warp);
  if (!twist) return twist.error();
  const bool is_solid = !*twist;
  const double mm = millimetres_per(units), area = yarn::area(woven.section, woven.size);
  const bool has_size =
      thread.diameter || (thread.section && yarn::nominal_size(*thread.section).width > 0.0);
  made.aspect = woven.size.width / woven.size.height;
  made.packing = constants.packing;
  if (is_solid) {
    made.packing = made.max_packing = 1.0;
    made.stiffness = stiffness_of_solids;
  } else {
    made.max_packing = mechanics::densest_packing;
    made.stiffness = mechanics::stiffness_by_twist(**twist);
  }
  if (thread.linear_density && thread.fibre_density()) {
    made.fibre_area = thread.linear_density->tex() / (1000.0 * *thread.fibre_density()) / (mm * mm);
    // A size that the text gives is that of the yarn at rest.
    if (has_size && !is_solid) made.packing = std::min(made.fibre_area / area, made.max_packing);
    if (is_solid) made.fibre_area = area;
  } else {
    if (!is_solid)
      made.packing = std::min(thread.size_packing().value_or(constants.packing), made.max_packing);
    made.fibre_area = made.packing * area;
  }
  return made;
}

std::vector<double> gaps_of(const System& system, int count) {
  std::vector<double> gaps;
  gaps.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k)
    gaps.push_back(system.offsets.empty() ? system.text->pitch : system.at(k + 1) - system.at(k));
  return gaps;
}

}  // namespace

Result<mechanics::WovenCloth> woven_cloth(const ClothText& text) {
  constexpr std::uint64_t most_repeat_crossings = 4'000'000;  // of a repeat
  mechanics::WovenCloth cloth;
  const auto repeat_of = [](const System& system, long long changes) {
    return static_cast<std::uint64_t>(std::lcm(changes, system.repeat_of_threads()));
  };
  if (product_of(repeat_of(*text.warp, text.drawdown->repeat_of_ends()),
                 repeat_of(*text.weft, text.drawdown->repeat_of_picks())) > most_repeat_crossings)
    return error(Kind::limit, fmt::format("its repeat has more than {} crossings", most_repeat_crossings));
  const auto add = [&](const System& system, long long repeat, bool is_warp,
                       std::vector<mechanics::WovenYarn>& yarns, std::vector<double>& gaps) -> Status {
    const auto count = static_cast<int>(std::lcm(repeat, system.repeat_of_threads()));
    for (int k = 0; k < count; ++k) {
      Result<mechanics::WovenYarn> yarn =
          woven_yarn(system.thread(k), text.fabric->units, is_warp, cloth.constants);
      if (!yarn) return yarn.error();
      yarn->fibre_area *= text.yarns * text.yarns;
      yarns.push_back(*yarn);
    }
    gaps = gaps_of(system, count);
    return {};
  };
  if (Status added = add(*text.warp, text.drawdown->repeat_of_ends(), true, cloth.warps, cloth.warp_gaps);
      !added)
    return added.error();
  if (Status added = add(*text.weft, text.drawdown->repeat_of_picks(), false, cloth.wefts, cloth.weft_gaps);
      !added)
    return added.error();
  for (int pick = 0; pick < cloth.picks(); ++pick)
    for (int end = 0; end < cloth.ends(); ++end)
      cloth.warp_on_top.push_back(text.drawdown->warp_on_top(pick, end) ? 1 : 0);
  switch (state_of(*text.weave)) {
    case Weave::State::loom:
      cloth.weft_tension = cloth.constants.loom_tension;
      break;
    case Weave::State::relaxed:
      cloth.warp_tension = cloth.weft_tension = mechanics::relaxed_tension;
      break;
    case Weave::State::finished:
      break;
  }
  cloth.clearance = text.clearance;
  cloth.thickness = text.weave->thickness;
  cloth.warp_share = text.weave->crimp;
  return cloth;
}

Result<ClothInEquilibrium> ClothInEquilibrium::find(const ClothText& text) {
  Result<mechanics::WovenCloth> cloth = woven_cloth(text);
  if (!cloth) return cloth.error();
  Result<mechanics::WovenEquilibrium> equilibrium = mechanics::find_equilibrium(*cloth);
  if (!equilibrium) return equilibrium.error().placed(text.weave->place);
  return ClothInEquilibrium(text, std::move(*cloth), std::move(*equilibrium));
}

ClothInEquilibrium::ClothInEquilibrium(const ClothText& text, mechanics::WovenCloth cloth,
                                       mechanics::WovenEquilibrium equilibrium)
    : warp_(*text.warp),
      weft_(*text.weft),
      state_(state_of(*text.weave)),
      millimetres_(millimetres_per(text.fabric->units)),
      cloth_(std::move(cloth)),
      equilibrium_(std::move(equilibrium)) {
  bottom_ = std::numeric_limits<double>::infinity();
  top_ = -bottom_;
  for (const bool is_weft : {false, true}) {
    const int yarns = is_weft ? cloth_.picks() : cloth_.ends(),
              crossings = is_weft ? cloth_.ends() : cloth_.picks();
    for (int yarn = 0; yarn < yarns; ++yarn) {
      const nurbs::Curve line =
          unclamped(is_weft, yarn, 0, static_cast<long long>(crossings) * mechanics::spans_a_gap);
      for (int k = 0; k < crossings * mechanics::spans_a_gap; ++k) {
        const auto size =
            equilibrium_.size(system_of(is_weft), yarn, static_cast<double>(k) / mechanics::spans_a_gap);
        const double z = nurbs::evaluate(line, knot(is_weft, k)).z();
        top_ = std::max(top_, z + 0.5 * size.height);
        bottom_ = std::min(bottom_, z - 0.5 * size.height);
        max_width_[is_weft ? 1 : 0] = std::max(max_width_[is_weft ? 1 : 0], size.width);
        max_height_[is_weft ? 1 : 0] = std::max(max_height_[is_weft ? 1 : 0], size.height);
      }
    }
  }
}

double ClothInEquilibrium::knot(bool is_weft, long long index) const {
  return (is_weft ? warp_ : weft_).at(static_cast<double>(index) / mechanics::spans_a_gap);
}

double ClothInEquilibrium::control_height(bool is_weft, long long yarn, long long index) const {
  const long long yarns = is_weft ? cloth_.picks() : cloth_.ends(),
                  knots = mechanics::spans_a_gap *
                          static_cast<long long>(is_weft ? cloth_.ends() : cloth_.picks());
  return equilibrium_.control_height(system_of(is_weft), static_cast<int>(wrapped(yarn, yarns)),
                                     static_cast<int>(wrapped(index, knots)));
}

// Over knots first .. last and two more at either side.
nurbs::Curve ClothInEquilibrium::unclamped(bool is_weft, long long yarn, long long first,
                                           long long last) const {
  nurbs::Curve line;
  for (long long k = first - 3; k <= last + 3; ++k) line.knots.push_back(knot(is_weft, k));
  for (long long k = first - 1; k <= last + 1; ++k)
    line.points.emplace_back((knot(is_weft, k - 1) + knot(is_weft, k) + knot(is_weft, k + 1)) / 3.0, 0.0,
                             control_height(is_weft, yarn, k));
  return line;
}

double ClothInEquilibrium::height(bool is_weft, long long yarn, long long crossing) const {
  const long long at = crossing * mechanics::spans_a_gap;
  return nurbs::evaluate(unclamped(is_weft, yarn, at - 1, at + 1), knot(is_weft, at)).z() -
         0.5 * (top_ + bottom_);
}

yarn::SectionSize ClothInEquilibrium::size(bool is_weft, long long yarn, long long crossing) const {
  const long long yarns = is_weft ? cloth_.picks() : cloth_.ends();
  const auto size = equilibrium_.size(system_of(is_weft), static_cast<int>(wrapped(yarn, yarns)),
                                      static_cast<double>(crossing));
  return {size.width, size.height};
}

void ClothInEquilibrium::shape(YarnPlan& plan, bool is_weft, long long yarn, double from, double to,
                               Vec3 (*to_place)(double s, double z, double across)) const {
  constexpr int stations = 8;  // of sizes, from crossing to crossing
  const System& crossed = is_weft ? warp_ : weft_;
  const auto crossing_near = [&](double s) {
    return static_cast<long long>(std::floor(s / crossed.text->pitch));
  };
  const long long first = crossing_near(from) - 2, last = crossing_near(to) + 2;
  nurbs::Curve line = nurbs::restricted(
      unclamped(is_weft, yarn, first * mechanics::spans_a_gap, last * mechanics::spans_a_gap), from, to);
  const double middle = 0.5 * (top_ + bottom_);
  for (Vec3& point : line.points) point = to_place(point.x(), point.z() - middle, 0.0);
  const auto parameter = [&](double s) { return std::clamp((s - from) / (to - from), 0.0, 1.0); };
  for (double& knot : line.knots) knot = parameter(knot);
  plan.line.curve = std::move(line);
  plan.line.closed = false;
  plan.line.parameters.clear();
  plan.points.clear();
  plan.spec.sizes.clear();
  const auto yarns = static_cast<long long>(is_weft ? cloth_.picks() : cloth_.ends());
  const auto own = static_cast<int>(wrapped(yarn, yarns));
  for (long long k = first * stations; k <= last * stations; ++k) {
    const double crossings = static_cast<double>(k) / stations, s = crossed.at(crossings);
    if (s < from || s > to) continue;
    const auto size = equilibrium_.size(system_of(is_weft), own, crossings);
    plan.spec.sizes.push_back({parameter(s), {size.width, size.height}, 0.0});
    if (k % stations != 0) continue;
    plan.points.push_back(to_place(s, height(is_weft, yarn, k / stations), 0.0));
    plan.line.parameters.push_back(parameter(s));
  }
  const yarn::SectionSize size = plan.spec.sizes.front().size;
  plan.spec.section = plan.thread.section.emplace(yarn::Ellipse{size.width, size.height});
  plan.thread.packing = packing(is_weft, yarn);
}

double ClothInEquilibrium::packing(bool is_weft, long long yarn) const {
  const auto& yarns = is_weft ? cloth_.wefts : cloth_.warps;
  const auto own = static_cast<std::size_t>(wrapped(yarn, static_cast<long long>(yarns.size())));
  const int halves = 2 * (is_weft ? cloth_.ends() : cloth_.picks());
  double sum = 0.0;
  for (int half = 0; half < halves; ++half) {
    const auto size = equilibrium_.size(system_of(is_weft), static_cast<int>(own), 0.5 * half);
    sum +=
        yarns[own].fibre_area / yarn::area(yarn::Ellipse{size.width, size.height}, {size.width, size.height});
  }
  return sum / halves;
}

EquilibriumReport ClothInEquilibrium::report() const {
  EquilibriumReport made;
  made.state = state_ == Weave::State::loom      ? "loom"
               : state_ == Weave::State::relaxed ? "relaxed"
                                                 : "finished";
  for (const bool is_weft : {false, true}) {
    const int yarns = is_weft ? cloth_.picks() : cloth_.ends(),
              crossings = is_weft ? cloth_.ends() : cloth_.picks();
    EquilibriumReport::System system;
    system.name = is_weft ? "weft" : "warp";
    const double weight = 1.0 / (static_cast<double>(yarns) * crossings);
    for (int yarn = 0; yarn < yarns; ++yarn) {
      for (int crossing = 0; crossing < crossings; ++crossing) {
        const auto here = equilibrium_.size(system_of(is_weft), yarn, crossing),
                   between = equilibrium_.size(system_of(is_weft), yarn, crossing + 0.5);
        system.width += weight * millimetres_ * here.width;
        system.height += weight * millimetres_ * here.height;
        system.width_between += weight * millimetres_ * between.width;
        system.axis_height += weight * millimetres_ * std::abs(height(is_weft, yarn, crossing));
        system.height_between += weight * millimetres_ * between.height;
      }
      system.packing += packing(is_weft, yarn) / yarns;
    }
    system.crimp = equilibrium_.crimp(system_of(is_weft));
    made.systems.push_back(system);
  }
  const mechanics::WovenEnergy energy = equilibrium_.energy();
  const double whole = energy.sum() > 0.0 ? energy.sum() : 1.0;
  made.energy = energy.sum();
  made.bending = energy.bending / whole;
  made.tension = energy.tension / whole;
  made.flattening = energy.flattening / whole;
  made.compaction = energy.compaction / whole;
  made.steps = equilibrium_.steps();
  made.residual = equilibrium_.residual();
  made.num_classes = equilibrium_.num_classes();
  return made;
}

}  // namespace selvage::fabric
