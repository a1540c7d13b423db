#include "formats/wif/values.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace selvage::formats::wif {

namespace {

// The whole of `text` as a number, with an optional '+'.
template <class T>
std::optional<T> parsed(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  T value{};
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

Spot spot_in(const Entry& entry, std::string_view part) {
  return entry.value_spot.behind(static_cast<std::size_t>(part.data() - entry.value.data()));
}

std::optional<int> whole(const Entry& entry, std::string_view text, TextReport& report) {
  if (const std::optional<int> value = parsed<int>(text)) return value;
  return report.error(spot_in(entry, text), text.empty()
                                                ? fmt::format("{} has no value", in_quotes(entry.key))
                                                : fmt::format("{} is no whole number", in_quotes(text)));
}

std::optional<int> key_number(const Entry& entry, std::string_view noun, TextReport& report) {
  const std::optional<int> number = parsed<int>(entry.key);
  if (number && *number >= 1) return number;
  return report.error(entry.key_spot,
                      number ? fmt::format("there is no {} {}: they count from 1", noun, *number)
                             : fmt::format("{} is not the number of a {}", in_quotes(entry.key), noun));
}

// Of a number beyond counted.most.
bool is_taken(int number, const Counted& counted) {
  return counted.is_soft && number <= most_threads;
}

std::string beyond(int number, const Counted& counted) {
  return counted.limit.empty()
             ? fmt::format("{} {} is beyond the {} that are taken", counted.noun, number, counted.most)
             : fmt::format("{} {} is beyond the {} {}s of {}", counted.noun, number, counted.most,
                           counted.noun, counted.limit);
}

}  // namespace

std::string_view without_comment(std::string_view value) {
  return trimmed(value.substr(0, value.find(';')));
}

std::optional<int> whole_number(const Entry& entry, TextReport& report) {
  return whole(entry, without_comment(entry.value), report);
}

std::optional<double> real_number(const Entry& entry, TextReport& report) {
  const std::string_view text = without_comment(entry.value);
  const std::optional<double> value = parsed<double>(text);
  if (value && std::isfinite(*value)) return value;
  const bool has_comma = text.find(',') != std::string_view::npos;
  return report.error(entry.value_spot,
                      text.empty() ? fmt::format("{} has no value", in_quotes(entry.key))
                                   : fmt::format("{} is no number{}", in_quotes(text),
                                                 has_comma ? ": a decimal comma? WIF has the point" : ""));
}

std::optional<bool> boolean(const Entry& entry, TextReport& report) {
  const std::string_view text = without_comment(entry.value);
  for (const std::string_view word : {"true", "on", "yes", "1"})
    if (same_word(text, word)) return true;
  for (const std::string_view word : {"false", "off", "no", "0"})
    if (same_word(text, word)) return false;
  return report.error(entry.value_spot,
                      fmt::format("{} is neither true (on, yes, 1) nor false (off, no, 0)", in_quotes(text)));
}

std::optional<std::vector<int>> whole_numbers(const Entry& entry, TextReport& report) {
  std::vector<int> values;
  for (const std::string_view part : split(without_comment(entry.value), ',')) {
    if (trimmed(part).empty()) continue;
    const std::optional<int> value = whole(entry, trimmed(part), report);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

bool Numbered::is_nothing() const {
  const std::string_view value = without_comment(entry->value);
  return value.empty() || parsed<int>(value) == 0;
}

void Surplus::add(int number, const Spot& spot) {
  if (numbers_.empty()) first_ = spot;
  numbers_.insert(number);
}

void Surplus::report_of(const Section& section, TextReport& report) const {
  if (numbers_.empty()) return;
  const std::string more =
      numbers_.size() > 1 ? fmt::format(" (and {} more)", numbers_.size() - 1) : std::string();
  report.warning(first_, fmt::format("[{}] has {} {}{}, and {} says {} {}s: it is taken as the loom has it",
                                     section.name, counted_.noun, *numbers_.begin(), more, counted_.limit,
                                     counted_.most, counted_.noun));
}

bool is_within(int number, const Counted& counted, const Entry& entry, Surplus* surplus, TextReport& report) {
  if (number >= 1 && number <= counted.most) return true;
  if (number > counted.most && is_taken(number, counted) && surplus != nullptr) {
    surplus->add(number, entry.value_spot);
    return true;
  }
  report.error(entry.value_spot,
               number < 1 ? fmt::format("there is no {} {}: they count from 1", counted.noun, number)
                          : beyond(number, counted));
  return false;
}

std::vector<Numbered> numbered(const Section& section, const Counted& counted, TextReport& report) {
  std::vector<Numbered> lines;
  lines.reserve(section.entries.size());
  Surplus surplus(counted);
  for (const Entry& entry : section.entries) {
    if (!entry.has_value) report.warning(entry.key_spot, "a line without '='");
    const std::optional<int> number = key_number(entry, counted.noun, report);
    if (!number) continue;
    const Numbered line{*number, &entry};
    if (*number <= counted.most) {
      lines.push_back(line);
    } else if (line.is_nothing()) {
      report.warning(entry.key_spot, beyond(*number, counted) + "; it is passed by");
    } else if (is_taken(*number, counted)) {
      surplus.add(*number, entry.key_spot);
      lines.push_back(line);
    } else {
      report.error(entry.key_spot, beyond(*number, counted),
                   counted.limit.empty() ? Kind::limit : Kind::malformed);
    }
  }
  surplus.report_of(section, report);
  std::stable_sort(lines.begin(), lines.end(),
                   [](const Numbered& a, const Numbered& b) { return a.number < b.number; });
  std::vector<Numbered> once;
  once.reserve(lines.size());
  for (const Numbered& line : lines) {
    if (once.empty() || once.back().number != line.number)
      once.push_back(line);
    else
      report.warning(line.entry->key_spot, fmt::format("{} {} stands here once more; the first one counts",
                                                       counted.noun, line.number));
  }
  return once;
}

}  // namespace selvage::formats::wif
