#include "fabric/weave_pressed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "core/rounding.h"
#include "fabric/weave_press.h"

namespace selvage::fabric {

namespace {

// Is there a crossing beside which both yarns change sides, on one of its four quarters.
bool change_together(const Drawdown& drawdown) {
  for (int pick = 0; pick < drawdown.picks; ++pick)
    for (int end = 0; end < drawdown.ends; ++end) {
      const bool here = drawdown.warp_on_top(pick, end);
      const bool along_warp =
          drawdown.warp_on_top(pick - 1LL, end) != here || drawdown.warp_on_top(pick + 1LL, end) != here;
      if (along_warp &&
          (drawdown.warp_on_top(pick, end - 1LL) != here || drawdown.warp_on_top(pick, end + 1LL) != here))
        return true;
    }
  return false;
}

// The share of a section that is fibre; none where the thread does not say it.
std::optional<double> packing_of(const WovenThread& woven, Unit units) {
  const Thread& thread = *woven.thread;
  if (!thread.linear_density || !thread.fibre_density()) return std::nullopt;
  const double mm = millimetres_per(units), area = yarn::area(woven.section, woven.size) * mm * mm;
  return thread.linear_density->tex() / (1000.0 * *thread.fibre_density() * area);
}

// A system as it presses: the widest of its threads, as thick as the thickest.
PressedSystem pressed_system(const System& system, Unit units) {
  PressedSystem pressed;
  const auto narrower = [](const WovenThread& a, const WovenThread& b) {
    return a.size.width < b.size.width;
  };
  pressed.section = std::max_element(system.threads.begin(), system.threads.end(), narrower)->section;
  pressed.size = {system.widest, system.thickest};
  pressed.pitch = system.closest;
  pressed.room = system.room;
  double densest = 0.0;
  for (const WovenThread& woven : system.threads)
    densest = std::max(densest, packing_of(woven, units).value_or(densest_packing));
  pressed.least_area = std::min(1.0, densest / densest_packing);
  return pressed;
}

void change_sections(System& system, const std::function<yarn::Section(const WovenThread&)>& change) {
  system.thickest = system.widest = 0.0;
  for (WovenThread& woven : system.threads) {
    woven.section = change(woven);
    woven.size = yarn::nominal_size(woven.section);
    system.thickest = std::max(system.thickest, woven.size.height);
    system.widest = std::max(system.widest, woven.size.width);
  }
}

PressedCloth built(const LooseCloth& cloth, const Pressed& pressed) {
  PressedCloth result{cloth.warp, cloth.weft, {}, {}, {}, 0.0};
  const auto press_sections = [](System& system, const PressedYarn& yarn) {
    change_sections(
        system, [&](const WovenThread& woven) { return pressed_section(woven.section, woven.size, yarn); });
  };
  press_sections(result.warp, pressed.warp);
  press_sections(result.weft, pressed.weft);
  result.warp_bend = {pressed.warp.flat / result.weft.widest, pressed.warp.radius};
  result.weft_bend = {pressed.weft.flat / result.warp.widest, pressed.weft.radius};
  const double rise = pressed.warp.height + pressed.weft.height;
  result.heights.clearance = rise - 0.5 * (result.warp.thickest + result.weft.thickest);
  result.heights.shift = 0.5 * (result.warp.thickest + result.heights.clearance) - pressed.warp.height;
  const WovenPair pair{&result.warp, &result.weft, cloth.drawdown, result.warp_bend, result.weft_bend};
  result.gap = crossing_gap(pair, result.heights, 0.0);
  return result;
}

}  // namespace

bool can_press(const LooseCloth& cloth) {
  for (const System* system : {&cloth.warp, &cloth.weft})
    for (const WovenThread& woven : system->threads)
      if (!can_be_pressed(woven.section)) return false;
  return true;
}

namespace {

std::optional<PressedCloth> press_once(const LooseCloth& cloth) {
  constexpr int most_tries = 6;
  constexpr double near = 0.9, least = 0.5;  // of the clearance
  // Of half of both thicknesses: what lies further apart at its crossings is no cloth that anything holds
  // together.
  constexpr double most_lift = 0.25;
  constexpr double thickness_slack = 1.01;
  PressedSystems systems;
  systems.warp = pressed_system(cloth.warp, cloth.units);
  systems.weft = pressed_system(cloth.weft, cloth.units);
  std::tie(systems.warp.changes, systems.weft.changes) = changes_of(*cloth.drawdown);
  systems.change_together = change_together(*cloth.drawdown);
  systems.clearance = cloth.clearance;
  systems.warp_share = cloth.crimp;
  systems.thickness = cloth.thickness;
  std::optional<PressedCloth> best;
  for (int attempt = 0; attempt < most_tries; ++attempt) {
    const Pressed pressed = press(systems);
    if (!pressed.is_sound) break;
    PressedCloth result = built(cloth, pressed);
    const double gap = result.gap;
    if (cloth.thickness && result.thickness() > thickness_slack * *cloth.thickness) break;
    if (result.heights.clearance > 0.5 * most_lift * (result.warp.thickest + result.weft.thickest)) break;
    if (gap >= least * cloth.clearance && (!best || gap > best->gap)) best = std::move(result);
    if (gap >= near * cloth.clearance) break;
    // Through the cloth it is more than from surface to surface, by the slopes. In coarse steps: what the
    // unit of the text has left in the gap is less.
    constexpr double steps = 64;
    const double more = std::clamp(cloth.clearance / std::max(gap, 0.01 * cloth.clearance), 1.05, 2.5);
    systems.clearance *= std::round(steps * more) / steps;
  }
  return best;
}

// Thicknesses that a cloth is pressed to, each a two hundredth below the one before, from that which it has
// by itself. Not every one of them is found by a search of its own: once one is found, all larger ones are
// accepted, and the search ends after `most_failures` failures in a row.
constexpr double thickness_factor = 0.995;
constexpr int most_failures = 40;

// From the largest of them on that is not above `most` down: calls use(thickness, cloth) until it says that
// it is enough.
template <class Use>
void for_thicknesses(LooseCloth cloth, double free, double most, const Use& use) {
  int failures = 0;
  for (double thickness = free; failures < most_failures; thickness *= thickness_factor) {
    if (thickness > most) continue;
    cloth.thickness = thickness;
    std::optional<PressedCloth> pressed = press_once(cloth);
    failures = pressed ? 0 : failures + 1;
    if (pressed && use(thickness, *pressed)) return;
  }
}

// As thick as it is by itself.
std::optional<double> free_thickness(LooseCloth cloth) {
  cloth.thickness.reset();
  const std::optional<PressedCloth> pressed = press_once(cloth);
  return pressed ? std::optional(pressed->thickness()) : std::nullopt;
}

}  // namespace

std::optional<PressedCloth> press_cloth(const LooseCloth& cloth) {
  if (!cloth.thickness) return press_once(cloth);
  const std::optional<double> free = free_thickness(cloth);
  if (!free) return std::nullopt;
  std::optional<PressedCloth> thinner;
  for_thicknesses(cloth, *free, *cloth.thickness, [&](double, PressedCloth& pressed) {
    thinner = std::move(pressed);
    return true;
  });
  if (!thinner) return std::nullopt;
  std::optional<PressedCloth> pressed = press_once(cloth);
  return pressed ? std::move(pressed) : std::move(thinner);
}

std::string pressing_of(const WovenThread& loose, const WovenThread& pressed, Unit units) {
  std::string text = fmt::format("pressed from {:.4g} x {:.4g} to {:.4g} x {:.4g} {}", loose.size.width,
                                 loose.size.height, pressed.size.width, pressed.size.height, name_of(units));
  const double before = yarn::area(loose.section, loose.size),
               after = yarn::area(pressed.section, pressed.size);
  if (after > 0.999 * before) return text + ", of the same area";
  if (const std::optional<double> packing = packing_of(loose, units))
    text += fmt::format(", the packing of its fibres rises from {:.3g} to {:.3g}", *packing,
                        *packing * before / after);
  return text;
}

namespace {

// A cloth with other pitches or thinner yarns.
struct Easier {
  double warp_pitch = 1, weft_pitch = 1, yarns = 1;  // factors
};

bool has_room(const LooseCloth& cloth, const Easier& easier, const HasRoom& tried) {
  WeaveSystem warp_text = *cloth.warp.text, weft_text = *cloth.weft.text;
  warp_text.pitch *= easier.warp_pitch;
  weft_text.pitch *= easier.weft_pitch;
  LooseCloth changed = cloth;
  changed.warp.text = &warp_text;
  changed.weft.text = &weft_text;
  changed.warp.room *= easier.warp_pitch;
  changed.warp.closest *= easier.warp_pitch;
  changed.weft.room *= easier.weft_pitch;
  changed.weft.closest *= easier.weft_pitch;
  for (System* system : {&changed.warp, &changed.weft})
    change_sections(*system, [&](const WovenThread& woven) {
      return yarn::with_lengths(woven.section, [&](double length) { return easier.yarns * length; });
    });
  return tried(changed, easier.yarns);
}

// The smallest factor from `low` on, to 1 %, at which the cloth has room; none up to 4.
std::optional<double> least_factor(double low, const std::function<bool(double)>& has_room_at) {
  double high = 1.1 * low;
  while (!has_room_at(high)) {
    low = high;
    high *= 1.25;
    if (high > 4.0) return std::nullopt;
  }
  while (high - low > 0.01) {
    const double middle = 0.5 * (low + high);
    (has_room_at(middle) ? high : low) = middle;
  }
  return high;
}

// Not coarser than it is.
std::string shown(const LinearDensity& density) {
  return fmt::format("{} {:.6g}", name_of(density.measure),
                     density.is_indirect() ? rounded_up(density.value) : rounded_down(density.value));
}

// A key of a draft's system; a section for its single threads would win over it.
std::string in_wif(const WifSystem& wif, std::string_view key, double value,
                   std::optional<std::string_view> section_of_threads) {
  std::string text = fmt::format("`{}={:.6g}` in [{}]", key, value, wif.section);
  if (section_of_threads) text += fmt::format(" without [{} {}]", wif.section, *section_of_threads);
  return text;
}

std::string spacing_in_wif(const WifSystem& wif, double millimetres) {
  return in_wif(wif, "Spacing", rounded_up(millimetres / wif.millimetres),
                wif.has_spacings ? std::optional("SPACING") : std::nullopt);
}

std::string thickness_in_wif(const WifSystem& wif, double millimetres) {
  return in_wif(wif, "Thickness", rounded_down(millimetres / wif.millimetres),
                wif.has_thicknesses ? std::optional("THICKNESS") : std::nullopt);
}

// The pitch that shown_pitch() gives.
double as_shown(const WeaveSystem& system, double pitch, Unit units) {
  const double mm = millimetres_per(units);
  if (system.wif) return rounded_up(pitch * mm / system.wif->millimetres) * system.wif->millimetres / mm;
  if (!system.counted_on) return rounded_up(pitch);
  return *system.counted_on / rounded_down(*system.counted_on / (pitch * mm)) / mm;
}

// As the text gives pitches: a distance, or so many on a length. Not closer than it is (file units).
std::string shown_pitch(const WeaveSystem& system, double pitch, Unit units) {
  if (system.wif) return spacing_in_wif(*system.wif, pitch * millimetres_per(units));
  if (!system.counted_on) return fmt::format("`pitch {:.6g}`", rounded_up(pitch));
  return fmt::format("`{:.6g}/{}`", rounded_down(*system.counted_on / (pitch * millimetres_per(units))),
                     *system.counted_on == 10 ? "cm" : "in");
}

// A draft has one thickness a system: all threads as thin as the thinnest.
std::string thinner_in_wif(const System& system, double by, Unit units) {
  double least = system.thickest;
  for (const WovenThread& woven : system.threads) least = std::min(least, woven.size.height);
  return thickness_in_wif(*system.text->wif, by * least * millimetres_per(units));
}

std::string thinner_threads(const LooseCloth& cloth, double by) {
  if (cloth.warp.text->wif)
    return fmt::format("{} and {}", thinner_in_wif(cloth.warp, by, cloth.units),
                       thinner_in_wif(cloth.weft, by, cloth.units));
  std::string text;
  std::set<const Thread*> seen;
  for (const System* system : {&cloth.warp, &cloth.weft})
    for (const WovenThread& woven : system->threads) {
      const Thread& thread = *woven.thread;
      if (!seen.insert(&thread).second) continue;
      const auto size = [&](double value) { return rounded_down(by * value); };
      const bool has_size = thread.diameter || (thread.section && woven.size.width > 0.0 &&
                                                yarn::nominal_size(*thread.section).width > 0.0);
      std::string now;
      if (!has_size && thread.linear_density)
        now = fmt::format("`{}`", shown(thread.linear_density->times(by * by)));
      else if (std::holds_alternative<yarn::Circle>(woven.section))
        now = fmt::format("`diameter {:.6g}`", size(woven.size.height));
      else
        now = fmt::format("a section of {:.6g} x {:.6g}", size(woven.size.width), size(woven.size.height));
      text += fmt::format("{}{} for thread '{}'", text.empty() ? "" : " and ", now, thread.name);
    }
  return text;
}

}  // namespace

std::optional<double> least_thickness(const LooseCloth& cloth) {
  const std::optional<double> free = free_thickness(cloth);
  if (!free) return std::nullopt;
  // In large steps to where the first one fails, from there in small ones.
  constexpr int large = 8;
  double least = *free;
  LooseCloth thinner = cloth;
  for (double next = least; thinner.thickness = next, press_once(thinner);) {
    least = next;
    for (int step = 0; step < large; ++step) next *= thickness_factor;
  }
  for_thicknesses(cloth, *free, least, [&](double thickness, PressedCloth&) {
    least = thickness;
    return false;
  });
  return rounded_up(least);
}

std::string remedies_for(const LooseCloth& cloth) {
  return remedies_for(cloth,
                      [](const LooseCloth& changed, double) { return press_cloth(changed).has_value(); });
}

std::string remedies_for(const LooseCloth& cloth, const HasRoom& tried) {
  const double warp_pitch = cloth.warp.text->pitch, weft_pitch = cloth.weft.text->pitch;
  const auto shown_factor = [&](bool is_warp, double by) {
    const WeaveSystem& system = is_warp ? *cloth.warp.text : *cloth.weft.text;
    return as_shown(system, by * system.pitch, cloth.units) / system.pitch;
  };
  const std::optional<double> wider = least_factor(1.0, [&](double by) {
    return has_room(cloth, {shown_factor(true, by), shown_factor(false, by), 1.0}, tried);
  });
  if (!wider) return "no pitch up to four times as large gives it: its yarns are too thick";
  double thinner = 1.0 / *wider;
  while (!has_room(cloth, {1.0, 1.0, thinner}, tried) && thinner > 0.2) thinner *= 0.99;
  const double percent = 100.0 * (*wider - 1.0);
  std::string text = fmt::format(
      "both ways it is {:.{}f} % too dense. Remedies: {} for the warp and {} for the weft; or {}", percent,
      percent < 10.0 ? 1 : 0, shown_pitch(*cloth.warp.text, *wider * warp_pitch, cloth.units),
      shown_pitch(*cloth.weft.text, *wider * weft_pitch, cloth.units), thinner_threads(cloth, thinner));
  // One system alone, the denser one if that is enough.
  const auto alone = [&](bool is_warp) -> std::optional<std::string> {
    const double pitch = is_warp ? warp_pitch : weft_pitch;
    const auto factor = least_factor(*wider, [&](double by) {
      return has_room(cloth,
                      {is_warp ? shown_factor(true, by) : 1.0, is_warp ? 1.0 : shown_factor(false, by), 1.0},
                      tried);
    });
    if (!factor) return std::nullopt;
    return fmt::format(
        "; or {} for the {} alone",
        shown_pitch(is_warp ? *cloth.warp.text : *cloth.weft.text, *factor * pitch, cloth.units),
        is_warp ? "warp" : "weft");
  };
  const bool warp_is_denser = cloth.warp.widest * cloth.weft.closest > cloth.weft.widest * cloth.warp.closest;
  std::optional<std::string> one = alone(warp_is_denser);
  if (!one) one = alone(!warp_is_denser);
  text += one.value_or("");
  return text;
}

}  // namespace selvage::fabric
