#include "fabric/weave_press.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/rounding.h"
#include "fabric/interlacing.h"

namespace selvage::fabric {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

// What the energies weigh beside that of a section's change of height to width. Tension: with 3 the
// thickness of five measured weaves of one warp and one weft (Vlakna a textil 1/2018, no. 6;
// samples/trade/blend_*) is 9 % off (rms), with 1 it is 14 %.
constexpr double closer_weight = 2.0, pointed_weight = 0.25, bending_weight = 1.0, tension_weight = 3.0,
                 lift_weight = 3.0;
constexpr double steepest_angle = 1.35, least_angle = 0.02;  // radians
constexpr double least_radius = 0.55;                        // of an arc, by the thickness of what bends
constexpr double most_pointed = 1.0;  // exponents above the own: the ellipse may become a lens

// What is looked for, system after system.
constexpr Eigen::Index per_system = 6;
enum Unknown { flatter, closer, pointed, angle, flat, radius };

bool has_power(const yarn::Section& section) {
  return !std::holds_alternative<yarn::Lenticular>(section) &&
         !std::holds_alternative<yarn::Racetrack>(section);
}

double own_exponent(const yarn::Section& section) {
  const auto* power = std::get_if<yarn::Power>(&section);
  return power != nullptr ? power->exponent : 1.0;
}

// Area of the unit power section, width and height 1: the integral of (1 - u^2)^(n/2) over half of it.
double power_area(double exponent) {
  return 0.5 * std::sqrt(pi) * std::tgamma(1.0 + 0.5 * exponent) / std::tgamma(1.5 + 0.5 * exponent);
}

// The width of a section of this area and height.
double width_for(const yarn::Section& section, double area, double height, double exponent) {
  if (has_power(section)) return area / (height * power_area(exponent));
  if (std::holds_alternative<yarn::Racetrack>(section))
    return std::max((area - 0.25 * pi * height * height) / height, 0.0) + height;
  double width = 1.5 * area / height;
  for (int step = 0; step < 12; ++step) width *= area / yarn::area(section, {width, height});
  return width;
}

// Half the thickness of a section at a distance across from its middle, 0 beyond its edge.
double half_thickness(const yarn::Section& section, const yarn::SectionSize& size, double exponent,
                      double across) {
  const auto [width, height] = size;
  const double edge = 0.5 * width, y = std::min(std::abs(across), edge);
  if (std::holds_alternative<yarn::Lenticular>(section)) {
    const double arc = (width * width + height * height) / (4.0 * height);
    return std::max(0.0, std::sqrt(arc * arc - y * y) - (arc - 0.5 * height));
  }
  if (std::holds_alternative<yarn::Racetrack>(section)) {
    const double beyond = std::max(0.0, y - std::max(0.0, 0.5 * (width - height)));
    return std::sqrt(std::max(0.0, 0.25 * height * height - beyond * beyond));
  }
  return 0.5 * height * std::pow(std::max(0.0, 1.0 - (y / edge) * (y / edge)), 0.5 * exponent);
}

// A yarn's section and path.
struct State {
  const yarn::Section* section = nullptr;
  yarn::SectionSize size;
  double exponent = 1;
  double height = 0, flat = 0, radius = 0;  // as of PressedYarn
  double angle = 0, straight = 0;           // of the way between two crossings
  double sine = 0, cosine = 1;              // of the angle
  double pitch = 0;                         // of what it crosses
};

void press_section(State& state, const PressedSystem& system, double height_share, double area_share,
                   double pointed) {
  const bool powers = has_power(system.section);
  state.section = &system.section;
  state.exponent = own_exponent(system.section) + (powers ? pointed : 0.0);
  const double area = powers
                          ? system.size.width * system.size.height * power_area(own_exponent(system.section))
                          : yarn::area(system.section, system.size);
  state.size.height = height_share * system.size.height;
  state.size.width = width_for(system.section, area_share * area, state.size.height, state.exponent);
}

State state_of(const PressedSystem& system, double crossed_pitch, const double* x) {
  State state;
  press_section(state, system, std::exp(-x[flatter]), std::exp(-x[closer]), x[pointed]);
  state.pitch = crossed_pitch;
  state.flat = x[flat];
  state.radius = x[radius];
  state.angle = x[angle];
  state.sine = std::sin(state.angle);
  state.cosine = std::cos(state.angle);
  state.straight = (crossed_pitch - 2.0 * state.flat - 2.0 * state.radius * state.sine) / state.cosine;
  state.height = state.radius * (1.0 - state.cosine) + 0.5 * state.straight * state.sine;
  return state;
}

// The side of a yarn on top, at `depth` below its axis, at s from the crossing, up to half a pitch: a
// parallel curve of the axis.
double lower_side(const State& state, bool changes, double s, double depth) {
  if (!changes || s <= state.flat) return state.height - depth;
  const double inner = state.radius - depth, sine = state.sine;
  const double arc_end = state.flat + inner * sine;
  const auto over = [](double r, double d) { return std::sqrt(std::max(0.0, r * r - d * d)); };
  if (s <= arc_end) return state.height - state.radius + over(inner, s - state.flat);
  const double outer = state.radius + depth, next_arc = state.pitch - state.flat - outer * sine;
  if (s <= next_arc)
    return state.height - state.radius + inner * state.cosine - (s - arc_end) * sine / state.cosine;
  return -state.height + state.radius - over(outer, state.pitch - state.flat - s);
}

// Crossings that are different: does the warp change sides beside it, does the weft. One where both do is
// the tightest of all.
std::vector<std::array<bool, 2>> crossings_of(const PressedSystems& systems) {
  if (systems.change_together) return {{true, true}};
  return {{systems.warp.changes, false}, {false, systems.weft.changes}};
}

// The gaps of yarns that cross, through the cloth, at looks x looks places of a quarter of each crossing;
// closest to one another at the edges, where sections end steeply.
template <class Use>
void for_gaps(const PressedSystems& systems, const State& warp, const State& weft, Use&& use) {
  constexpr std::size_t looks = 10;
  // Distances from the crossing along the warp and along the weft, and half the weft's and the warp's
  // thickness there.
  std::array<double, looks> s{}, y{}, weft_half{}, warp_half{};
  for (std::size_t i = 0; i < looks; ++i) {
    const double share = 0.5 * std::sin(0.5 * pi * static_cast<double>(i) / (looks - 1));
    s[i] = share * weft.size.width;
    y[i] = share * warp.size.width;
    weft_half[i] = half_thickness(*weft.section, weft.size, weft.exponent, s[i]);
    warp_half[i] = half_thickness(*warp.section, warp.size, warp.exponent, y[i]);
  }
  for (const auto& [warp_changes, weft_changes] : crossings_of(systems))
    for (std::size_t i = 0; i < looks; ++i)
      for (std::size_t k = 0; k < looks; ++k)
        use(lower_side(warp, warp_changes, s[i], warp_half[k]) +
            lower_side(weft, weft_changes, y[k], weft_half[i]));
}

class Energy {
 public:
  explicit Energy(const PressedSystems& systems)
      : systems_(systems), scale_(0.5 * (systems.warp.size.height + systems.weft.size.height)) {}

  [[nodiscard]] State warp(const VectorXd& x) const {
    return state_of(systems_.warp, systems_.weft.room, x.data());
  }
  [[nodiscard]] State weft(const VectorXd& x) const {
    return state_of(systems_.weft, systems_.warp.room, x.data() + per_system);
  }
  [[nodiscard]] double scale() const { return scale_; }

  // Half of their sum of squares is the energy, with `stiffness` times what is not allowed.
  [[nodiscard]] VectorXd residuals(const VectorXd& x, double stiffness) const {
    std::vector<double> r;
    const double stiff = std::sqrt(stiffness);
    const auto forbid = [&](double excess) { r.push_back(stiff * std::max(0.0, excess)); };
    const State states[] = {warp(x), weft(x)};
    add_system(systems_.warp, states[0], x.data(), r, forbid);
    add_system(systems_.weft, states[1], x.data() + per_system, r, forbid);
    const double rise = states[0].height + states[1].height;
    const double lift = rise - 0.5 * (states[0].size.height + states[1].size.height) - systems_.clearance;
    r.push_back(std::sqrt(lift_weight) * lift / scale_);
    if (systems_.warp_share)
      r.push_back(2.0 * stiff * (states[0].height - *systems_.warp_share * rise) / scale_);
    if (systems_.thickness)
      for (const State& state : states)
        forbid((2.0 * state.height + state.size.height - *systems_.thickness) / scale_);
    for_gaps(systems_, states[0], states[1],
             [&](double gap) { forbid((systems_.clearance - gap) / scale_); });
    return Eigen::Map<const VectorXd>(r.data(), static_cast<Eigen::Index>(r.size()));
  }

 private:
  template <class Forbid>
  void add_system(const PressedSystem& system, const State& state, const double* x, std::vector<double>& r,
                  const Forbid& forbid) const {
    const auto add = [&](double weight, double value) { r.push_back(std::sqrt(weight) * value); };
    add(1.0, x[flatter]);
    add(closer_weight, x[closer]);
    add(pointed_weight, x[pointed]);
    const double thick = state.size.height;
    if (system.changes) {
      add(bending_weight * std::abs(state.angle) / (std::max(state.radius, 0.1 * thick) * state.pitch),
          0.25 * thick);
      const double length = 2.0 * (state.flat + state.radius * state.angle) + state.straight;
      add(tension_weight * std::max(1e-6, length / state.pitch - 1.0), 1.0);
    }
    const bool is_flat = system.size.width >= system.size.height;
    forbid(-3.0 * x[closer]);
    forbid(3.0 * (x[closer] + std::log(system.least_area)));
    forbid(-3.0 * x[pointed]);
    forbid(3.0 * (x[pointed] - (has_power(system.section) ? most_pointed : 0.0)));
    forbid(3.0 * (x[angle] - steepest_angle));
    forbid(3.0 * (least_angle - x[angle]));
    for (const double excess :
         {state.size.width - system.pitch + systems_.clearance, -state.straight,
          least_radius * thick - state.radius, -state.flat, is_flat ? thick - state.size.width : 0.0})
      forbid(2.0 * excess / scale_);
  }

  const PressedSystems& systems_;
  double scale_;
};

// Levenberg and Marquardt, with what is not allowed weighing more and more.
VectorXd descend(const Energy& energy, VectorXd x) {
  constexpr int most_steps = 40, most_tries = 10;
  constexpr double nudge = 1e-6;
  for (const double stiffness : {1e1, 1e2, 1e3, 1e4, 1e5}) {
    double damping = 1e-2;
    VectorXd r = energy.residuals(x, stiffness);
    for (int step = 0; step < most_steps; ++step) {
      MatrixXd slopes(r.size(), x.size());
      for (Eigen::Index k = 0; k < x.size(); ++k) {
        VectorXd beside = x;
        beside[k] += nudge;
        slopes.col(k) = (energy.residuals(beside, stiffness) - r) / nudge;
      }
      const MatrixXd normal = slopes.transpose() * slopes;
      const VectorXd downhill = -slopes.transpose() * r;
      const double before = r.squaredNorm();
      double after = before;
      for (int attempt = 0; attempt < most_tries && after >= before; ++attempt) {
        MatrixXd damped = normal;
        damped.diagonal() += damping * (normal.diagonal() + VectorXd::Constant(x.size(), 1e-6));
        const VectorXd next = x + damped.ldlt().solve(downhill);
        const VectorXd there = energy.residuals(next, stiffness);
        if (there.squaredNorm() < before) {
          x = next;
          r = there;
          after = r.squaredNorm();
          damping = std::max(0.3 * damping, 1e-9);
        } else {
          damping *= 4.0;
        }
      }
      if (!(before - after > 1e-9 * before)) break;
    }
  }
  return x;
}

PressedYarn pressed_yarn(const PressedSystem& system, const State& state, const double* x) {
  PressedYarn yarn{std::exp(-x[flatter]),
                   std::clamp(std::exp(-x[closer]), system.least_area, 1.0),
                   x[pointed],
                   state.height,
                   state.flat,
                   state.radius};
  constexpr double hardly = 0.005;
  if (!has_power(*state.section) || std::abs(yarn.pointed) < hardly) yarn.pointed = 0.0;
  // Rounding, and the last of what is not allowed, must not leave a path without a bridge.
  yarn.flat = std::clamp(yarn.flat, 0.0, 0.49 * state.pitch);
  const double along = state.pitch - 2.0 * yarn.flat, rise = 2.0 * yarn.height;
  if (rise > 0.0)
    yarn.radius = std::min(yarn.radius, (1.0 - 1e-9) * 0.25 * (along * along + rise * rise) / rise);
  return yarn;
}

// As it will be built.
State state_of(const PressedSystem& system, double crossed_pitch, const PressedYarn& yarn) {
  State state;
  press_section(state, system, yarn.height_share, yarn.area_share, yarn.pointed);
  state.pitch = crossed_pitch;
  state.height = yarn.height;
  state.flat = yarn.flat;
  state.radius = yarn.radius;
  const std::optional<Bridge> bridge =
      find_bridge(crossed_pitch - 2.0 * yarn.flat, 2.0 * yarn.height, 2.0 * yarn.radius);
  if (bridge) state.angle = bridge->angle;
  return state;
}

bool is_sound(const PressedSystem& system, const State& state) {
  return state.size.width <= system.pitch && state.radius > 0.5 * state.size.height &&
         (!system.changes || state.angle > 0.0);
}

}  // namespace

bool can_be_pressed(const yarn::Section& section) {
  return !std::holds_alternative<yarn::Polygon>(section);
}

yarn::Section pressed_section(const yarn::Section& section, const yarn::SectionSize& size,
                              const PressedYarn& pressed) {
  const PressedSystem alone{section, size};
  State state;
  press_section(state, alone, pressed.height_share, pressed.area_share, pressed.pointed);
  const auto [width, height] = state.size;
  if (std::holds_alternative<yarn::Lenticular>(section)) return yarn::Lenticular{width, height};
  if (std::holds_alternative<yarn::Racetrack>(section)) return yarn::Racetrack{width, height};
  if (state.exponent == 1.0) return yarn::Ellipse{width, height};
  return yarn::Power{width, height, state.exponent};
}

namespace {

PressedSystems in_ratios(PressedSystems systems, double unit) {
  const auto ratio = [&](double length) { return in_units_of(unit, length); };
  for (PressedSystem* system : {&systems.warp, &systems.weft}) {
    system->section = yarn::with_lengths(system->section, ratio);
    for (double* length : {&system->size.width, &system->size.height, &system->pitch, &system->room})
      *length = ratio(*length);
    system->least_area = in_units_of(1, system->least_area);
  }
  systems.clearance = ratio(systems.clearance);
  if (systems.thickness) systems.thickness = ratio(*systems.thickness);
  return systems;
}

// The systems' mean thickness is 1.
Pressed press_in_ratios(const PressedSystems& systems) {
  const Energy energy(systems);
  VectorXd best;
  double least = std::numeric_limits<double>::infinity();
  for (const double start : {0.3, 0.7, 1.1}) {
    VectorXd x = VectorXd::Zero(2 * per_system);
    for (const Eigen::Index system : {Eigen::Index{0}, per_system}) {
      x[system + angle] = start;
      x[system + radius] = energy.scale();
    }
    x = descend(energy, x);
    const double found = energy.residuals(x, 1e4).squaredNorm();
    if (found < least) {
      least = found;
      best = x;
    }
  }
  Pressed pressed{pressed_yarn(systems.warp, energy.warp(best), best.data()),
                  pressed_yarn(systems.weft, energy.weft(best), best.data() + per_system), false};
  const State warp = state_of(systems.warp, systems.weft.room, pressed.warp),
              weft = state_of(systems.weft, systems.warp.room, pressed.weft);
  pressed.is_sound = is_sound(systems.warp, warp) && is_sound(systems.weft, weft);
  return pressed;
}

}  // namespace

Pressed press(const PressedSystems& systems) {
  const double unit = 0.5 * (systems.warp.size.height + systems.weft.size.height);
  Pressed pressed = press_in_ratios(in_ratios(systems, unit));
  for (PressedYarn* yarn : {&pressed.warp, &pressed.weft})
    for (double* length : {&yarn->height, &yarn->flat, &yarn->radius}) *length *= unit;
  return pressed;
}

}  // namespace selvage::fabric
