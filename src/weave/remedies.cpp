#include "weave/remedies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "core/rounding.h"

namespace selvage::fabric {

System scaled(System system, double by) {
  system.thickest = system.widest = 0.0;
  const auto scale = [&](WovenThread& woven) {
    woven.section = yarn::with_lengths(woven.section, [&](double length) { return by * length; });
    woven.size = yarn::nominal_size(woven.section);
    system.thickest = std::max(system.thickest, woven.size.height);
    system.widest = std::max(system.widest, woven.size.width);
  };
  std::ranges::for_each(system.threads, scale);
  for (std::vector<WovenThread>& column : system.columns) std::ranges::for_each(column, scale);
  return system;
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
  changed.warp = scaled(changed.warp, easier.yarns);
  changed.weft = scaled(changed.weft, easier.yarns);
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

std::string thinner_threads(const LooseCloth& cloth, double by) {
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

double as_shown(const WeaveSystem& system, double pitch, Unit units) {
  const double mm = millimetres_per(units);
  const int ends = system.ends_of_one;
  if (!system.counted_on) return rounded_up(pitch * ends) / ends;
  return *system.counted_on / rounded_down(*system.counted_on / (pitch * ends * mm)) / mm / ends;
}

std::string shown_pitch(const WeaveSystem& system, double pitch, Unit units) {
  pitch *= system.ends_of_one;
  if (!system.counted_on) return fmt::format("`pitch {:.6g}`", rounded_up(pitch));
  return fmt::format("`{:.6g}/{}`", rounded_down(*system.counted_on / (pitch * millimetres_per(units))),
                     *system.counted_on == 10 ? "cm" : "in");
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
