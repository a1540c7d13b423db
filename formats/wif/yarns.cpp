#include "formats/wif/yarns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "formats/wif/palette.h"

namespace selvage::formats::wif {

namespace {

// What one system says, before the two are put together. Lengths are in the system's own unit.
struct SystemText {
  std::string name;  // WARP
  const Section* section = nullptr;
  Counted threads;
  std::size_t count = 0;  // of the cloth
  std::vector<std::optional<Color>> colors;
  std::optional<double> spacing;  // the mean
  std::vector<std::optional<double>> thicknesses;
  std::optional<double> unit;  // millimetres in one; nothing: there are no lengths
  std::optional<Unit> keeps;   // the model's own unit that it is, if any
};

// The lengths that a system gives for each of its threads; nothing where it is silent. Zero says nothing
// either.
std::vector<std::optional<double>> read_lengths(const Ini& ini, const SystemText& system,
                                                std::string_view what, TextReport& report) {
  const auto length = [&](const Entry& entry) -> std::optional<double> {
    if (without_comment(entry.value).empty()) return std::nullopt;
    const std::optional<double> value = real_number(entry, report);
    constexpr double largest = 1e6;
    if (value && (*value < 0 || *value > largest))
      report.error(entry.value_spot, fmt::format("a {} lies between 0 and {:g}", what, largest));
    return value && *value > 0 ? value : std::nullopt;
  };
  const Entry* const common = system.section->find(what);
  const std::optional<double> value = common != nullptr ? length(*common) : std::nullopt;
  std::vector<std::optional<double>> values(system.count, value);
  const Section* const section = ini.find(fmt::format("{} {}", system.name, what));
  if (section == nullptr) return values;
  for (const Numbered& line : numbered(*section, system.threads, report)) {
    const std::optional<double> own = length(*line.entry);
    if (own && static_cast<std::size_t>(line.number) <= system.count)
      values[static_cast<std::size_t>(line.number) - 1] = own;
  }
  return values;
}

// A weave has one pitch a system.
std::optional<double> mean_spacing(const SystemText& system,
                                   const std::vector<std::optional<double>>& spacings, TextReport& report) {
  double sum = 0;
  int known = 0;
  std::optional<double> first;
  bool is_even = true;
  for (const std::optional<double>& spacing : spacings) {
    if (!spacing) continue;
    if (!first) first = spacing;
    is_even = is_even && spacing == first;
    sum += *spacing;
    ++known;
  }
  if (is_even) return first;
  const double mean = sum / known;
  report.warning(
      system.section->spot,
      fmt::format("the spacing of [{}] varies; every thread gets the mean, {:.6g}", system.name, mean));
  return mean;
}

struct LengthUnit {
  std::string_view word;
  double millimetres;
  std::optional<Unit> same;
};
constexpr LengthUnit length_units[] = {{"centimeters", 10, Unit::cm},
                                       {"cm", 10, Unit::cm},
                                       {"inches", 25.4, Unit::inch},
                                       {"inch", 25.4, Unit::inch},
                                       {"decipoints", 25.4 / 720, {}},
                                       {"millimeters", 1, Unit::mm},
                                       {"mm", 1, Unit::mm}};

void read_unit(SystemText& system, TextReport& report) {
  const Entry* const entry = system.section->find("Units");
  const std::string_view word = entry != nullptr ? without_comment(entry->value) : std::string_view();
  const LengthUnit* unit = length_units;
  if (word.empty()) {
    report.warning(system.section->spot,
                   fmt::format("[{}] has lengths but no Units; centimeters are taken", system.name));
  } else {
    unit = std::find_if(std::begin(length_units), std::end(length_units),
                        [&](const LengthUnit& one) { return same_word(one.word, word); });
    if (unit == std::end(length_units)) {
      report.error(entry->value_spot,
                   fmt::format("{} is no unit of a WIF: decipoints, inches, centimeters", in_quotes(word)));
      return;
    }
  }
  system.unit = unit->millimetres;
  system.keeps = unit->same;
}

SystemText read_system(const Ini& ini, std::string name, const Counted& threads, int count,
                       const Palette& palette, TextReport& report) {
  SystemText system;
  system.name = std::move(name);
  system.section = ini.find(system.name);
  system.threads = threads;
  system.count = static_cast<std::size_t>(count);
  system.colors = read_colors(ini, *system.section, threads, system.count, palette, report);
  const std::vector<std::optional<double>> spacings = read_lengths(ini, system, "Spacing", report);
  system.spacing = mean_spacing(system, spacings, report);
  system.thicknesses = read_lengths(ini, system, "Thickness", report);
  const bool has_thickness = std::any_of(system.thicknesses.begin(), system.thicknesses.end(),
                                         [](const std::optional<double>& one) { return one.has_value(); });
  if (system.spacing || has_thickness) read_unit(system, report);
  return system;
}

// Both systems' lengths keep the numbers of the file where they are in one unit of the model.
Unit common_unit(const SystemText& warp, const SystemText& weft) {
  const SystemText& first = warp.unit ? warp : weft;
  const bool differ = warp.unit && weft.unit && warp.keeps != weft.keeps;
  return differ ? Unit::mm : first.keeps.value_or(Unit::mm);
}

double in_unit(double length, const SystemText& system, Unit unit) {
  return system.keeps == unit ? length : length * *system.unit / millimetres_per(unit);
}

// Names a thread after its colour's number; the same colour in another thickness gets another thread.
class ThreadNames {
 public:
  explicit ThreadNames(std::vector<fabric::Thread>& threads) : threads_(threads) {}

  std::string name_of(const std::optional<Color>& color, double diameter, TextPlace place) {
    const std::string stem = color ? fmt::format("color{}", color->number) : std::string("yarn");
    std::map<double, std::size_t>& same = by_stem_[stem];
    const auto [known, is_new] = same.try_emplace(diameter, threads_.size());
    if (!is_new) return threads_[known->second].name;
    fabric::Thread thread;
    thread.name = same.size() == 1 ? stem : fmt::format("{}_{}", stem, same.size());
    thread.place = place;
    thread.diameter = diameter;
    if (color) thread.color = color->rgb;
    threads_.push_back(std::move(thread));
    return threads_.back().name;
  }

 private:
  std::vector<fabric::Thread>& threads_;
  std::map<std::string, std::map<double, std::size_t>> by_stem_;  // by the diameter
};

// The fewest names that give the list when they are used in turn.
std::vector<std::string> shortest_repeat(std::vector<std::string> names) {
  // The border of each prefix (Knuth, Morris, Pratt): the whole's border is what the repeat leaves over.
  std::vector<std::size_t> border(names.size() + 1);
  for (std::size_t i = 1; i < names.size(); ++i) {
    std::size_t length = border[i];
    while (length > 0 && names[i] != names[length]) length = border[length];
    border[i + 1] = names[i] == names[length] ? length + 1 : 0;
  }
  names.resize(names.size() - border[names.size()]);
  return names;
}

fabric::WeaveSystem placed(const SystemText& system, double pitch, double usual_diameter, Unit unit,
                           ThreadNames& threads) {
  fabric::WeaveSystem made;
  made.is_drawn = true;
  made.place = system.section->spot.place();
  made.count = static_cast<int>(system.count);
  made.pitch = pitch;
  for (std::size_t i = 0; i < system.count; ++i)
    made.threads.push_back(threads.name_of(
        system.colors[i],
        system.thicknesses[i] ? in_unit(*system.thicknesses[i], system, unit) : usual_diameter, made.place));
  made.threads = shortest_repeat(std::move(made.threads));
  return made;
}

}  // namespace

Yarns read_yarns(const Ini& ini, const Loom& loom, int ends, int picks, TextReport& report) {
  const Palette palette = read_palette(ini, report);
  const SystemText warp = read_system(ini, "WARP", loom.warp, ends, palette, report);
  const SystemText weft = read_system(ini, "WEFT", loom.weft, picks, palette, report);
  Yarns yarns;
  if (report.errors() > 0) return yarns;
  yarns.units = common_unit(warp, weft);
  const auto pitch = [&](const SystemText& system) -> std::optional<double> {
    if (!system.spacing) return std::nullopt;
    return in_unit(*system.spacing, system, yarns.units);
  };
  constexpr double usual_pitch = 1;  // mm
  const double other = pitch(warp).value_or(pitch(weft).value_or(usual_pitch / millimetres_per(yarns.units)));
  const double warp_pitch = other;
  const double weft_pitch = pitch(weft).value_or(other);
  const double usual_diameter = std::min(warp_pitch, weft_pitch) / 2;
  ThreadNames threads(yarns.threads);
  yarns.warp = placed(warp, warp_pitch, usual_diameter, yarns.units, threads);
  yarns.weft = placed(weft, weft_pitch, usual_diameter, yarns.units, threads);
  return yarns;
}

}  // namespace selvage::formats::wif
