#include "weave/system.h"

#include "weave/yarn_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "core/wrapped.h"
#include "fabric/clearance.h"
#include "fabric/quantities.h"
#include "fabric/repeat.h"
#include "fabric/yarn_spec.h"

namespace selvage::fabric {

long long System::repeat_of_threads() const {
  if (columns.empty())
    return smallest_shift(static_cast<long long>(threads.size()),
                          [&](long long i, long long k) { return thread(i).thread == thread(k).thread; });
  const auto count = static_cast<long long>(columns.size());
  return smallest_shift(count, [&](long long i, long long k) {
    return std::ranges::equal(
        columns[static_cast<std::size_t>(wrapped(i, count))],
        columns[static_cast<std::size_t>(wrapped(k, count))],
        [](const WovenThread& a, const WovenThread& b) { return a.thread == b.thread; });
  });
}

const WovenThread& System::thread(long long yarn, int layer) const {
  if (!columns.empty())
    return columns[static_cast<std::size_t>(wrapped(yarn, static_cast<long long>(columns.size())))]
                  [static_cast<std::size_t>(layer)];
  return threads[static_cast<std::size_t>(wrapped(yarn, static_cast<long long>(threads.size())))];
}

double System::at(double yarn) const {
  const double even = (yarn + 0.5) * text->pitch;
  if (offsets.empty()) return even;
  const double number = std::floor(yarn), beyond = yarn - number;
  const auto offset = [&](double of) {
    const auto count = static_cast<long long>(offsets.size());
    return offsets[static_cast<std::size_t>(wrapped(static_cast<long long>(of), count))];
  };
  return even + (1.0 - beyond) * offset(number) + (beyond > 0.0 ? beyond * offset(number + 1.0) : 0.0);
}

void space_evenly(System& system) {
  system.offsets.clear();
  system.room = system.closest = system.text->pitch;
}

void relax_spacing(System& system, const std::vector<int>& changes, double closest) {
  const double pitch = system.text->pitch;
  const auto floats = static_cast<double>(std::count(changes.begin(), changes.end(), 0));
  const double near = std::min(closest, pitch), freed = floats * (pitch - near);
  if (freed <= 0.0 || floats == static_cast<double>(changes.size())) return;
  const auto gap = [&](int count, double scale) {
    return count == 0 ? near : std::max(pitch, scale * std::pow(count, 0.25));
  };
  const auto together = [&](double scale) {
    double sum = 0.0;
    for (const int count : changes) sum += gap(count, scale);
    return sum;
  };
  const double wanted = static_cast<double>(changes.size()) * pitch;
  double low = 0.0, high = wanted;
  for (int step = 0; step < 200 && low < high; ++step) {
    const double middle = 0.5 * (low + high);
    (together(middle) < wanted ? low : high) = middle;
  }
  system.offsets = {0.0};
  double mean = 0.0;
  system.room = system.closest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const double here = gap(changes[i], low);
    system.closest = std::min(system.closest, here);
    if (changes[i] > 0) system.room = std::min(system.room, here);
    if (i + 1 < changes.size()) system.offsets.push_back(system.offsets.back() + here - pitch);
    mean += system.offsets[i] / static_cast<double>(changes.size());
  }
  for (double& offset : system.offsets) offset -= mean;
}

Result<WovenThread> woven_thread(const Fabric& fabric, const std::string& name, TextPlace place) {
  WovenThread woven;
  woven.thread = fabric.find_thread(name);
  if (woven.thread == nullptr)
    return error(Kind::geometry, fmt::format("there is no thread '{}'", name)).placed(place);
  Result<yarn::Section> section = centred_section_of(*woven.thread, fabric.units);
  if (!section)
    return error(Kind::geometry, fmt::format("thread '{}': {}", name, section.error().text))
        .placed(woven.thread->place);
  woven.section = *section;
  woven.size = yarn::nominal_size(woven.section);
  if (Status checked = yarn::check_section(woven.section, woven.size); !checked)
    return checked.error().placed(woven.thread->place);
  return woven;
}

double thickness_in_cloth(const System& system, Unit units, bool is_warp) {
  double thickest = 0.0;
  for (const WovenThread& woven : system.threads) {
    const Result<std::optional<double>> twist = twist_factor_of(*woven.thread, units, is_warp);
    const Thread& thread = *woven.thread;
    const bool is_flat = twist && *twist && **twist == 0.0 && !thread.section && !thread.diameter;
    const double flat =
        yarn::area(woven.section, woven.size) / (0.25 * std::numbers::pi * system.text->pitch);
    thickest = std::max(thickest, is_flat ? std::min(flat, woven.size.height) : woven.size.height);
  }
  return thickest;
}

Result<System> system_of(const Fabric& fabric, const WeaveSystem& text) {
  System system;
  system.text = &text;
  space_evenly(system);
  for (const std::string& name : text.threads) {
    Result<WovenThread> woven = woven_thread(fabric, name, text.place);
    if (!woven) return woven.error();
    system.thickest = std::max(system.thickest, woven->size.height);
    system.widest = std::max(system.widest, woven->size.width);
    system.threads.push_back(std::move(*woven));
  }
  if (Status fits = check_proportion("a pitch", text.pitch, system.widest, fabric.units, text.place); !fits)
    return fits.error();
  return system;
}

Status stack_columns(System& system, const Fabric& fabric, const std::vector<WarpColumn>& columns) {
  const std::size_t count = std::lcm(columns.size(), system.threads.size());
  std::vector<std::vector<WovenThread>> stacked;
  for (std::size_t c = 0; c < count; ++c) {
    std::vector<WovenThread>& column = stacked.emplace_back();
    for (const StackedWarp& warp : columns[c % columns.size()]) {
      column.push_back(system.thread(static_cast<long long>(c)));
      if (warp.thread.empty()) continue;
      Result<WovenThread> woven = woven_thread(fabric, warp.thread, warp.place);
      if (!woven) return woven.error();
      column.back() = std::move(*woven);
    }
  }
  system.columns = std::move(stacked);
  system.threads.clear();
  system.thickest = system.widest = 0.0;
  for (const std::vector<WovenThread>& column : system.columns)
    for (const WovenThread& woven : column) {
      system.thickest = std::max(system.thickest, woven.size.height);
      system.widest = std::max(system.widest, woven.size.width);
      system.threads.push_back(woven);
    }
  return check_proportion("a pitch", system.text->pitch, system.widest, fabric.units, system.text->place);
}

WovenThread filled(WovenThread woven) {
  if (!std::holds_alternative<yarn::Loop7>(woven.section)) return woven;
  const double diameter = 2.0 * outline_reach(woven.section);
  woven.section = yarn::Circle{diameter};
  woven.size = {diameter, diameter};
  return woven;
}

void fill(System& system) {
  system.thickest = system.widest = 0.0;
  for (WovenThread& woven : system.threads) {
    woven = filled(std::move(woven));
    system.thickest = std::max(system.thickest, woven.size.height);
    system.widest = std::max(system.widest, woven.size.width);
  }
}

std::optional<Bend> natural_bend(const System& crossed) {
  Bend bend = Bend::round;
  for (const WovenThread& woven : crossed.threads) {
    if (std::holds_alternative<yarn::Lenticular>(woven.section))
      bend = Bend::lens;
    else if (std::holds_alternative<yarn::Racetrack>(woven.section))
      bend = Bend::racetrack;
    else if (!std::holds_alternative<yarn::Circle>(woven.section) &&
             !std::holds_alternative<yarn::Loop7>(woven.section))
      return std::nullopt;
  }
  return bend;
}

namespace {

// The worst of all neighbouring pairs of the crossed system's threads, for the thickest own thread: {flats,
// spread}.
std::pair<double, double> worst_pair(const System& own, const System& crossed, Bend bend, double clearance) {
  std::pair<double, double> worst{0.0, 0.0};
  double least_room = std::numeric_limits<double>::infinity();
  // Equal threads need to be looked at once.
  std::set<std::pair<const Thread*, const Thread*>> seen;
  for (std::size_t j = 0; j < crossed.threads.size(); ++j) {
    const WovenThread &a = crossed.threads[j], &b = crossed.threads[(j + 1) % crossed.threads.size()];
    if (!seen.insert({a.thread, b.thread}).second) continue;
    const Obstacle first = obstacle_of(bend, a.size, own.thickest, clearance),
                   last = obstacle_of(bend, b.size, own.thickest, clearance);
    const std::pair<double, double> pair{first.flat + last.flat, first.radius + last.radius};
    const double room = largest_height(crossed.room - pair.first, pair.second);
    if (room < least_room || worst.second == 0.0) {
      least_room = room;
      worst = pair;
    }
  }
  return worst;
}

}  // namespace

double thickness_of(const System& warp, const System& weft, const Heights& heights) {
  double top = 0.0;
  for (const WovenThread& woven : warp.threads)
    top = std::max(top, heights.warp(woven.size.height) + 0.5 * woven.size.height);
  for (const WovenThread& woven : weft.threads)
    top = std::max(top, heights.weft(woven.size.height) + 0.5 * woven.size.height);
  return 2.0 * top;
}

double most_height(const System& own, const System& crossed, Bend bend, bool changes_sides,
                   double clearance) {
  if (!changes_sides) return std::numeric_limits<double>::infinity();
  const auto [flats, spread] = worst_pair(own, crossed, bend, clearance);
  return largest_height(crossed.room - flats, spread);
}

Result<Heights> share_crimp(const SystemPair& pair, const std::optional<double>& wanted, double clearance) {
  const System &warp = *pair.warp, &weft = *pair.weft;
  const double both = warp.thickest + weft.thickest + 2.0 * clearance;
  const double warp_most = most_height(warp, weft, pair.warp_bend, pair.warp_changes, clearance),
               weft_most = most_height(weft, warp, pair.weft_bend, pair.weft_changes, clearance);
  // A jammed cloth fits to the last bit only: rounding must not refuse it.
  const double slack = 1e-9 * both;
  const auto too_tight = [&](const System& own, const System& crossed, Bend bend, double height) {
    const auto [flats, spread] = worst_pair(own, crossed, bend, clearance);
    return error(Kind::geometry,
                 fmt::format(
                     "the pitch {:.6g} is too small: no yarn fits over and under these at a crimp height of "
                     "{:.6g}; the smallest pitch is {:.6g}",
                     crossed.room, height, flats + smallest_pitch(height, spread)))
        .placed(crossed.text->place);
  };
  double warp_height = wanted.value_or(0.5) * both;
  if (!wanted) {
    warp_height = std::min(warp_height, warp_most);
    if (both - warp_height > weft_most) warp_height = std::min(both, both - weft_most);
  }
  if (warp_height > warp_most + slack) {
    // With nothing asked for, equal shares tell what is missing.
    const double height = wanted ? warp_height : 0.5 * both;
    return height > warp_most + slack ? too_tight(warp, weft, pair.warp_bend, height)
                                      : too_tight(weft, warp, pair.weft_bend, height);
  }
  if (both - warp_height > weft_most + slack)
    return too_tight(weft, warp, pair.weft_bend, both - warp_height);
  // No axis of a thin thread may come to lie beyond the middle.
  double shift = 0.5 * (warp.thickest + clearance - warp_height);
  for (const WovenThread& woven : warp.threads)
    shift = std::min(shift, 0.5 * (woven.size.height + clearance));
  for (const WovenThread& woven : weft.threads)
    shift = std::max(shift, -0.5 * (woven.size.height + clearance));
  return Heights{shift, clearance};
}

}  // namespace selvage::fabric
