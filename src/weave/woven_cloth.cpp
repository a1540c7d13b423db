#include "weave/woven_cloth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "core/rounding.h"
#include "core/wrapped.h"
#include "nurbs/restrict.h"
#include "weave/yarn_kind.h"

namespace selvage::fabric {

namespace {

using mechanics::WovenSystem;

constexpr double stiffness_of_solids = 100;
constexpr double solid_packing = 0.9;

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

double axial_modulus(const Material& material) {  // MPa; 0: not known
  if (const auto* isotropic = std::get_if<IsotropicElastic>(&material.elastic)) return isotropic->modulus;
  if (const auto* transverse = std::get_if<TransverseElastic>(&material.elastic)) return transverse->e1;
  return 0.0;
}

// Tension of a finished cloth, N, of which the mechanics' bending stiffness is that of all fibres bent one by
// one: E A^2 / (4 pi n) of a yarn with n of them. Errors: what is not known of a thread (malformed).
Result<double> tension_of(const ClothText& text, const mechanics::WovenCloth& cloth) {
  double stiffness = 0.0, areas = 0.0;
  for (const bool is_weft : {false, true}) {
    const System& system = *(is_weft ? text.weft : text.warp);
    for (const WovenThread& woven : system.threads) {
      const Thread& thread = *woven.thread;
      const Material* const material =
          thread.material ? text.fabric->find_material_anywhere(*thread.material) : nullptr;
      const double modulus = material == nullptr ? 0.0 : axial_modulus(*material);
      if (modulus <= 0.0 || !thread.filaments || !thread.linear_density || !thread.fibre_density())
        return error(Kind::malformed,
                     fmt::format(
                         "how far a pressure presses thread '{}' follows from the bending of its fibres: it "
                         "needs 'filaments', a linear density, and a material with an elastic modulus; or "
                         "say 'fraction' in the place of 'compact'",
                         thread.name))
            .placed(thread.place);
      const double area = thread.linear_density->tex() / (1000.0 * *thread.fibre_density());  // mm2
      const double weight = 1.0 / static_cast<double>(system.threads.size());
      stiffness += weight * modulus * area * area / (4.0 * std::numbers::pi * *thread.filaments);
      areas += weight * area;
    }
  }
  return stiffness / (cloth.constants.bending * areas);
}

std::vector<double> gaps_of(const System& system, int count) {
  std::vector<double> gaps;
  gaps.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k)
    gaps.push_back(system.offsets.empty() ? system.text->pitch : system.at(k + 1) - system.at(k));
  return gaps;
}

// The last equilibrium is kept: a cloth and its data sheet are of one.
Result<mechanics::WovenEquilibrium> equilibrium_of(const mechanics::WovenCloth& cloth) {
  static std::mutex guard;
  static std::optional<std::pair<mechanics::WovenCloth, mechanics::WovenEquilibrium>> last;
  {
    const std::lock_guard lock(guard);
    if (last && last->first == cloth) return last->second;
  }
  Result<mechanics::WovenEquilibrium> found = mechanics::find_equilibrium(cloth);
  const std::lock_guard lock(guard);
  if (found) last.emplace(cloth, *found);
  return found;
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
  const Drawdown& drawdown = *text.drawdown;
  const auto column_of = [&](int column) { return wrapped(column, drawdown.columns()); };
  const auto warps_in = [&](int column) {
    return drawdown.first_end(column_of(column) + 1) - drawdown.first_end(column_of(column));
  };
  const auto add = [&](const System& system, long long repeat, bool is_warp,
                       std::vector<mechanics::WovenYarn>& yarns, std::vector<double>& gaps) -> Status {
    const auto count = static_cast<int>(std::lcm(repeat, system.repeat_of_threads()));
    for (int k = 0; k < count; ++k) {
      const int layers = is_warp ? warps_in(k) : drawdown.layers;
      for (int layer = 0; layer < layers; ++layer) {
        Result<mechanics::WovenYarn> yarn =
            woven_yarn(system.thread(k, layer), text.fabric->units, is_warp, cloth.constants);
        if (!yarn) return yarn.error();
        yarn->fibre_area *= text.yarns * text.yarns;
        yarns.push_back(*yarn);
      }
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
  cloth.wefts_a_row = drawdown.layers;
  if (!drawdown.first_ends.empty()) {
    cloth.first_warps = {0};
    for (int column = 0; column < cloth.columns(); ++column)
      cloth.first_warps.push_back(cloth.first_warps.back() + warps_in(column));
  }
  for (int pick = 0; pick < cloth.picks(); ++pick)
    for (int column = 0; column < cloth.columns(); ++column)
      for (int layer = 0; layer < warps_in(column); ++layer)
        cloth.warp_on_top.push_back(
            drawdown.warp_on_top(pick, drawdown.first_end(column_of(column)) + layer) ? 1 : 0);
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
  if (text.weave->pressure) {
    const Result<double> tension = tension_of(text, cloth);
    if (!tension) return tension.error();
    const double mm = millimetres_per(text.fabric->units);
    cloth.pressure = *text.weave->pressure * mechanics::mean_area(cloth) * mm * mm / *tension;
  }
  return cloth;
}

Result<ClothInEquilibrium> ClothInEquilibrium::find(const ClothText& text) {
  Result<mechanics::WovenCloth> cloth = woven_cloth(text);
  if (!cloth) return cloth.error();
  Result<mechanics::WovenEquilibrium> equilibrium = equilibrium_of(*cloth);
  if (!equilibrium) return equilibrium.error().placed(text.weave->place);
  ClothInEquilibrium made(text, *cloth, std::move(*equilibrium));
  if (const std::optional<double>& fraction = text.weave->fraction) {
    // The length of yarns depends on the thickness, but little.
    constexpr double exactness = 1e-7;
    constexpr int most_rounds = 20;
    if (made.fraction() > *fraction)
      return error(
          Kind::geometry,
          fmt::format("the cloth has a fibre fraction of {:.4g} by itself, more than {:.4g}: leave out "
                      "the fraction, or open the cloth",
                      made.fraction(), *fraction));
    for (int round = 0; round < most_rounds && std::abs(made.fraction() / *fraction - 1.0) > exactness;
         ++round) {
      cloth->thickness = made.thickness_for(*fraction);
      made = ClothInEquilibrium(text, *cloth, made.equilibrium_.pressed(*cloth->thickness));
      if (made.is_too_thick()) break;
    }
  }
  if (text.weave->pressure && made.is_solid()) return made.too_much_pressure(text);
  if (!made.is_too_thick()) return made;
  const std::string_view unit = name_of(text.fabric->units);
  if (!text.weave->fraction)
    return error(
        Kind::geometry,
        fmt::format("no cloth of these yarns is {:.6g} {} thick: in equilibrium it is {:.6g} {} at the "
                    "least",
                    *cloth->thickness, unit, rounded_up(made.equilibrium_.thickness()), unit));
  return error(
      Kind::geometry,
      fmt::format("the yarns of this cloth do not fill {:.4g} of it with fibre: {:.4g} at the most, at "
                  "packing fractions of {:.2f} (warp) and {:.2f} (weft)",
                  *text.weave->fraction, rounded_down(made.fraction()), made.report().systems[0].packing,
                  made.report().systems[1].packing));
}

bool ClothInEquilibrium::is_solid() const {
  const EquilibriumReport found = report();
  return std::all_of(found.systems.begin(), found.systems.end(),
                     [](const EquilibriumReport::System& system) { return system.packing > solid_packing; });
}

Message ClothInEquilibrium::too_much_pressure(const ClothText& text) const {
  constexpr double exactness = 1.01;
  double from = cloth_.constants.pressure, to = *cloth_.pressure;
  while (to > exactness * from) {
    mechanics::WovenCloth cloth = cloth_;
    cloth.pressure = std::sqrt(from * to);
    Result<mechanics::WovenEquilibrium> found = mechanics::find_equilibrium(cloth);
    const bool is_less = found && !ClothInEquilibrium(text, std::move(cloth), std::move(*found)).is_solid();
    (is_less ? from : to) = std::sqrt(from * to);
  }
  return error(Kind::geometry,
               fmt::format("a pressure of {:.6g} MPa is more than the yarns bear: at {:.3g} MPa fibres fill "
                           "{} of them (0.907: hexagons of round fibres)",
                           *text.weave->pressure,
                           rounded_down(*text.weave->pressure * from / *cloth_.pressure), solid_packing));
}

bool ClothInEquilibrium::is_too_thick() const {
  constexpr double exactness = 1e-6;
  return cloth_.thickness && equilibrium_.thickness() > *cloth_.thickness * (1.0 + exactness);
}

ClothInEquilibrium::ClothInEquilibrium(const ClothText& text, mechanics::WovenCloth cloth,
                                       mechanics::WovenEquilibrium equilibrium)
    : warp_(*text.warp),
      weft_(*text.weft),
      state_(state_of(*text.weave)),
      millimetres_(millimetres_per(text.fabric->units)),
      layers_(text.layers()),
      cloth_(std::move(cloth)),
      equilibrium_(std::move(equilibrium)) {
  bottom_ = std::numeric_limits<double>::infinity();
  top_ = -bottom_;
  for (const bool is_weft : {false, true}) {
    const int knots = crossings(is_weft) * mechanics::spans_a_gap;
    for (const ClothYarn& yarn : yarns(is_weft)) {
      const nurbs::Curve line = unclamped(yarn, 0, knots);
      for (int k = 0; k < knots; ++k) {
        const auto size = equilibrium_.size(system_of(is_weft), number(yarn),
                                            static_cast<double>(k) / mechanics::spans_a_gap);
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

int ClothInEquilibrium::number(const ClothYarn& yarn) const {
  const auto place = static_cast<int>(
      wrapped(yarn.place, static_cast<long long>(yarn.is_weft ? cloth_.rows() : cloth_.columns())));
  return (yarn.is_weft ? place * cloth_.wefts_a_row : cloth_.first_warp(place)) + yarn.layer;
}

std::vector<ClothYarn> ClothInEquilibrium::yarns(bool is_weft) const {
  std::vector<ClothYarn> made;
  for (int place = 0; place < crossings(!is_weft); ++place) {
    const int layers = is_weft ? cloth_.wefts_a_row : cloth_.first_warp(place + 1) - cloth_.first_warp(place);
    for (int layer = 0; layer < layers; ++layer) made.push_back({is_weft, place, layer});
  }
  return made;
}

double ClothInEquilibrium::control_height(const ClothYarn& yarn, long long index) const {
  const auto knots = static_cast<long long>(mechanics::spans_a_gap) * crossings(yarn.is_weft);
  return equilibrium_.control_height(system_of(yarn.is_weft), number(yarn),
                                     static_cast<int>(wrapped(index, knots)));
}

// Over knots first .. last and two more at either side.
nurbs::Curve ClothInEquilibrium::unclamped(const ClothYarn& yarn, long long first, long long last) const {
  const bool is_weft = yarn.is_weft;
  nurbs::Curve line;
  for (long long k = first - 3; k <= last + 3; ++k) line.knots.push_back(knot(is_weft, k));
  for (long long k = first - 1; k <= last + 1; ++k)
    line.points.emplace_back((knot(is_weft, k - 1) + knot(is_weft, k) + knot(is_weft, k + 1)) / 3.0, 0.0,
                             control_height(yarn, k));
  return line;
}

double ClothInEquilibrium::height(const ClothYarn& yarn, long long crossing) const {
  const long long at = crossing * mechanics::spans_a_gap;
  return nurbs::evaluate(unclamped(yarn, at - 1, at + 1), knot(yarn.is_weft, at)).z() -
         0.5 * (top_ + bottom_);
}

yarn::SectionSize ClothInEquilibrium::size(const ClothYarn& yarn, long long crossing) const {
  const auto size = equilibrium_.size(system_of(yarn.is_weft), number(yarn), static_cast<double>(crossing));
  return {size.width, size.height};
}

void ClothInEquilibrium::shape(YarnPlan& plan, const ClothYarn& yarn, double from, double to,
                               Vec3 (*to_place)(double s, double z, double across)) const {
  const bool is_weft = yarn.is_weft;
  constexpr int stations = 8;  // of sizes, from crossing to crossing
  const System& crossed = is_weft ? warp_ : weft_;
  const auto crossing_near = [&](double s) {
    return static_cast<long long>(std::floor(s / crossed.text->pitch));
  };
  const long long first = crossing_near(from) - 2, last = crossing_near(to) + 2;
  nurbs::Curve line = nurbs::restricted(
      unclamped(yarn, first * mechanics::spans_a_gap, last * mechanics::spans_a_gap), from, to);
  const double middle = 0.5 * (top_ + bottom_);
  for (Vec3& point : line.points) point = to_place(point.x(), point.z() - middle, 0.0);
  const auto parameter = [&](double s) { return std::clamp((s - from) / (to - from), 0.0, 1.0); };
  for (double& knot : line.knots) knot = parameter(knot);
  plan.line.curve = std::move(line);
  plan.line.closed = false;
  plan.line.parameters.clear();
  plan.points.clear();
  plan.spec.sizes.clear();
  for (long long k = first * stations; k <= last * stations; ++k) {
    const double crossings = static_cast<double>(k) / stations, s = crossed.at(crossings);
    if (s < from || s > to) continue;
    const auto size = equilibrium_.size(system_of(is_weft), number(yarn), crossings);
    plan.spec.sizes.push_back({parameter(s), {size.width, size.height}, 0.0});
    if (k % stations != 0) continue;
    plan.points.push_back(to_place(s, height(yarn, k / stations), 0.0));
    plan.line.parameters.push_back(parameter(s));
  }
  const yarn::SectionSize size = plan.spec.sizes.front().size;
  plan.spec.section = plan.thread.section.emplace(yarn::Ellipse{size.width, size.height});
  plan.thread.packing = packing(yarn);
}

double ClothInEquilibrium::fibre_volume() const {
  const auto sum = [](const std::vector<double>& gaps) {
    return std::accumulate(gaps.begin(), gaps.end(), 0.0);
  };
  double height = 0.0;
  for (const bool is_weft : {false, true}) {
    double areas = 0.0;
    for (const mechanics::WovenYarn& yarn : is_weft ? cloth_.wefts : cloth_.warps) areas += yarn.fibre_area;
    height += areas * (1.0 + equilibrium_.crimp(system_of(is_weft))) /
              sum(is_weft ? cloth_.weft_gaps : cloth_.warp_gaps);
  }
  return height;
}

double ClothInEquilibrium::fraction() const {
  return fibre_volume() * layers_ / (layers_ * thickness() + (layers_ - 1) * cloth_.clearance);
}

double ClothInEquilibrium::thickness_for(double fraction) const {
  return fibre_volume() / fraction - cloth_.clearance * (layers_ - 1) / layers_;
}

double ClothInEquilibrium::packing(const ClothYarn& yarn) const {
  constexpr int places_a_gap = 8;
  const auto own = static_cast<std::size_t>(number(yarn));
  const int places = places_a_gap * crossings(yarn.is_weft);
  double areas = 0.0;
  for (int place = 0; place < places; ++place) {
    const auto size = equilibrium_.size(system_of(yarn.is_weft), static_cast<int>(own),
                                        static_cast<double>(place) / places_a_gap);
    areas += yarn::area(yarn::Ellipse{size.width, size.height}, {size.width, size.height});
  }
  return (yarn.is_weft ? cloth_.wefts : cloth_.warps)[own].fibre_area * places / areas;
}

EquilibriumReport ClothInEquilibrium::report() const {
  EquilibriumReport made;
  made.state = state_ == Weave::State::loom      ? "loom"
               : state_ == Weave::State::relaxed ? "relaxed"
                                                 : "finished";
  for (const bool is_weft : {false, true}) {
    const std::vector<ClothYarn> all = yarns(is_weft);
    EquilibriumReport::System system;
    system.name = is_weft ? "weft" : "warp";
    const double weight = 1.0 / (static_cast<double>(all.size()) * crossings(is_weft));
    for (const ClothYarn& yarn : all) {
      for (int crossing = 0; crossing < crossings(is_weft); ++crossing) {
        const auto here = equilibrium_.size(system_of(is_weft), number(yarn), crossing),
                   between = equilibrium_.size(system_of(is_weft), number(yarn), crossing + 0.5);
        system.width += weight * millimetres_ * here.width;
        system.height += weight * millimetres_ * here.height;
        system.width_between += weight * millimetres_ * between.width;
        system.axis_height += weight * millimetres_ * std::abs(height(yarn, crossing));
        system.height_between += weight * millimetres_ * between.height;
      }
      system.packing += packing(yarn) / static_cast<double>(all.size());
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
