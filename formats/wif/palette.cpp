#include "formats/wif/palette.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace selvage::formats::wif {

namespace {

// "0,999" of the Range.
void read_range(const Entry& entry, Palette& palette, TextReport& report) {
  const std::optional<std::vector<int>> range = whole_numbers(entry, report);
  if (!range) return;
  if (range->size() != 2 || (*range)[0] >= (*range)[1]) {
    report.error(entry.value_spot, "a range is two whole numbers, the smaller one first");
    return;
  }
  palette.low = (*range)[0];
  palette.high = (*range)[1];
}

// Red, green and blue as the palette writes them, from values[from].
std::optional<yarn::Color> scaled(const std::vector<int>& values, std::size_t from, const Entry& entry,
                                  const Palette& palette, TextReport& report) {
  std::array<int, 3> parts{};
  const double size = static_cast<double>(palette.high) - palette.low;
  for (std::size_t i = 0; i < 3; ++i) {
    const int value = values[from + i];
    if (value < palette.low || value > palette.high)
      return report.error(entry.value_spot, fmt::format("{} is not within the colours' range, {} to {}",
                                                        value, palette.low, palette.high));
    parts[i] = static_cast<int>(std::lround((static_cast<double>(value) - palette.low) / size * 255));
  }
  return yarn::Color{parts[0], parts[1], parts[2]};
}

void read_table(const Section& section, Palette& palette, TextReport& report) {
  palette.has_table = true;
  for (const Numbered& line : numbered(section, {"color"}, report)) {
    const std::optional<std::vector<int>> values = whole_numbers(*line.entry, report);
    if (!values) continue;
    if (values->size() != 3) {
      report.error(line.entry->value_spot,
                   fmt::format("a colour is three whole numbers, not {}", values->size()));
      continue;
    }
    if (const auto color = scaled(*values, 0, *line.entry, palette, report))
      palette.colors[line.number] = *color;
  }
}

Color numbered_color(int number, const Palette& palette) {
  const auto found = palette.colors.find(number);
  return {number, found != palette.colors.end() ? std::optional(found->second) : std::nullopt};
}

std::string unknown(int number, const Palette& palette) {
  return palette.has_table ? fmt::format("color {} is not in [COLOR TABLE]", number)
                           : fmt::format("color {}, but there is no [COLOR TABLE]", number);
}

// The colour of threads that have none of their own: NUMBER, or NUMBER,RED,GREEN,BLUE.
struct CommonColor {
  const Entry* entry = nullptr;
  std::optional<Color> color;
  bool is_good = true;
};

CommonColor read_common(const Section& system, const Palette& palette, TextReport& report) {
  CommonColor common;
  const Entry* const entry = system.find("Color");
  if (entry == nullptr || without_comment(entry->value).empty()) return common;
  const std::optional<std::vector<int>> values = whole_numbers(*entry, report);
  if (!values || values->empty()) return common;
  common.entry = entry;
  common.color = numbered_color(values->front(), palette);
  if (values->size() == 4 && !common.color->rgb)
    common.color->rgb = scaled(*values, 1, *entry, palette, report);
  common.is_good = common.color->rgb.has_value();
  return common;
}

}  // namespace

Palette read_palette(const Ini& ini, TextReport& report) {
  Palette palette;
  const Section* const table = ini.find("COLOR TABLE");
  const Entry* const range = ini.find("COLOR PALETTE", "Range");
  if (range != nullptr)
    read_range(*range, palette, report);
  else if (table != nullptr)
    report.warning(table->spot, "[COLOR PALETTE] gives no Range; 0,255 is taken");
  if (table != nullptr) read_table(*table, palette, report);
  return palette;
}

std::vector<std::optional<Color>> read_colors(const Ini& ini, const Section& system, const Counted& threads,
                                              std::size_t count, const Palette& palette, TextReport& report) {
  const CommonColor common = read_common(system, palette, report);
  std::vector<std::optional<Color>> colors(count);
  std::vector<bool> has_own(count);
  if (const Section* const section = ini.find(fmt::format("{} COLORS", system.name))) {
    for (const Numbered& line : numbered(*section, threads, report)) {
      if (without_comment(line.entry->value).empty()) continue;
      const std::optional<int> number = whole_number(*line.entry, report);
      if (!number) continue;
      if (!palette.colors.contains(*number)) report.error(line.entry->value_spot, unknown(*number, palette));
      const std::size_t thread = static_cast<std::size_t>(line.number) - 1;
      if (thread >= count) continue;
      colors[thread] = numbered_color(*number, palette);
      has_own[thread] = true;
    }
  }
  const bool is_used = std::find(has_own.begin(), has_own.end(), false) != has_own.end();
  if (!common.is_good) {
    const int number = common.color->number;
    if (is_used && palette.has_table)
      report.error(common.entry->value_spot, unknown(number, palette));
    else
      report.warning(common.entry->value_spot,
                     unknown(number, palette) +
                         (is_used ? "; the threads stay without a colour" : "; no thread has it"));
  }
  for (std::size_t i = 0; i < count; ++i)
    if (!has_own[i] && common.is_good) colors[i] = common.color;
  return colors;
}

}  // namespace selvage::formats::wif
