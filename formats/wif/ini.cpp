#include "formats/wif/ini.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage::formats::wif {

namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

std::string_view without_mark(std::string_view bytes) {
  return bytes.starts_with(byte_order_mark) ? bytes.substr(byte_order_mark.size()) : bytes;
}

// Takes the next line, without its end, off the front of `rest`.
std::string_view next_line(std::string_view& rest) {
  const std::size_t length = std::min(rest.find_first_of("\r\n"), rest.size());
  const std::string_view line = rest.substr(0, length);
  const bool is_pair = rest.substr(length, 2) == "\r\n";
  rest.remove_prefix(std::min(length + (is_pair ? 2U : 1U), rest.size()));
  return line;
}

// The name between the brackets of a section's line; empty: it is none.
std::string_view section_name(std::string_view line) {
  const std::size_t close = line.rfind(']');
  if (!line.starts_with('[') || close == std::string_view::npos) return {};
  return trimmed(line.substr(1, close - 1));
}

std::string lowered(std::string_view text) {
  std::string lowered(text);
  std::ranges::transform(text, lowered.begin(), lower);
  return lowered;
}

}  // namespace

const Entry* Section::find(std::string_view key) const {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const Entry& entry) { return same_word(entry.key, key); });
  return found == entries.end() ? nullptr : &*found;
}

const Section* Ini::find(std::string_view name) const {
  const auto found = places_.find(lowered(name));
  return found == places_.end() ? nullptr : &sections_[found->second];
}

const Entry* Ini::find(std::string_view section, std::string_view key) const {
  const Section* const found = find(section);
  return found == nullptr ? nullptr : found->find(key);
}

Ini::Ini(const Source& source, TextReport& report) {
  const std::string_view bytes = source.bytes();
  std::string_view rest = without_mark(bytes);
  for (end_ = {bytes.size() - rest.size(), 1, 1}; !rest.empty();
       end_ = {bytes.size() - rest.size(), end_.line + 1, 1})
    read_line(next_line(rest), end_, report);
}

void Ini::open_section(std::string_view name, const Spot& spot, TextReport& report) {
  const auto [place, is_new] = places_.emplace(lowered(name), sections_.size());
  current_ = place->second;
  if (is_new)
    sections_.push_back({name, spot, {}});
  else
    report.warning(
        spot, fmt::format("the section {} stands here once more; its entries are joined", in_quotes(name)));
}

void Ini::read_line(std::string_view line, const Spot& begin, TextReport& report) {
  const std::string_view text = trimmed(line);
  if (text.empty() || text.starts_with(';')) return;
  const auto spot_of = [&](std::string_view part) {
    return begin.behind(static_cast<std::size_t>(part.data() - line.data()));
  };
  const Spot spot = spot_of(text);
  if (const std::string_view name = section_name(text); !name.empty())
    return open_section(name, spot, report);
  if (sections_.empty()) {
    if (!warned_of_prelude_) report.warning(spot, "text before the first section is passed by");
    warned_of_prelude_ = true;
    return;
  }
  const std::size_t equals = text.find('=');
  Entry entry;
  entry.has_value = equals != std::string_view::npos;
  entry.key = trimmed(text.substr(0, equals));
  entry.value = entry.has_value ? trimmed(text.substr(equals + 1)) : text.substr(text.size());
  entry.key_spot = spot;
  entry.value_spot = spot_of(entry.value);
  sections_[current_].entries.push_back(entry);
}

bool has_wif_section(std::string_view head) {
  head = without_mark(head);
  while (!head.empty())
    if (same_word(section_name(trimmed(next_line(head))), "WIF")) return true;
  return false;
}

}  // namespace selvage::formats::wif
