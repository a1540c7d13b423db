#include "core/text_report.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage {

namespace {

constexpr std::size_t excerpt_before = 60, excerpt_after = 50;  // bytes shown on either side of the caret

// What no text file holds.
bool is_foreign(char c) {
  return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7F;
}

// In an excerpt a character keeps its column: what cannot be shown is one '?'.
std::string made_readable(std::string_view bytes) {
  std::string text;
  text.reserve(bytes.size());
  while (!bytes.empty()) {
    const Character character = take_character(bytes);
    if (!character.is_valid || (character.bytes != "\t" && is_control(character.code())))
      text += '?';
    else
      text += character.bytes;
  }
  return text;
}

// The line round `spot`, cut to what fits a terminal, and the caret in it.
void add_excerpt(Message& message, const Spot& spot, std::string_view text) {
  const std::size_t at = std::min(spot.offset, text.size());
  const std::size_t column = std::min(at, static_cast<std::size_t>(std::max(spot.column, 1)) - 1);
  std::string_view left = text.substr(at - column, column), right = text.substr(at);
  left.remove_prefix(left.rfind('\n') + 1);  // npos + 1 is 0
  right = right.substr(0, right.substr(0, 2 * excerpt_after).find('\n'));
  const bool goes_on = right.size() > 2 * excerpt_after;
  if (goes_on) {
    std::size_t end = excerpt_after;
    while (end > 0 && is_continuation(right[end])) --end;
    right = right.substr(0, end);
  } else if (right.ends_with('\r')) {
    right.remove_suffix(1);
  } else if (right.empty() && left.ends_with('\r')) {
    left.remove_suffix(1);
  }
  std::string before;
  if (left.size() > 2 * excerpt_before) {
    left.remove_prefix(left.size() - excerpt_before);
    while (!left.empty() && is_continuation(left.front())) left.remove_prefix(1);
    before = "...";
  }
  before += made_readable(left);
  message.excerpt = before + made_readable(right) + (goes_on ? "..." : "");
  if (!message.excerpt.empty()) message.caret = static_cast<int>(before.size()) + 1;
}

}  // namespace

Spot spot_at(const Source& source, TextPlace place) {
  const std::string_view text = source.bytes();
  Spot begin;  // of the line
  for (; begin.line < place.line; ++begin.line) {
    const std::size_t newline = text.find('\n', begin.offset);
    if (newline == std::string_view::npos) return begin.behind(text.size() - begin.offset);
    begin.offset = newline + 1;
  }
  return begin.behind(
      std::min(static_cast<std::size_t>(std::max(place.column, 1)) - 1, text.size() - begin.offset));
}

std::size_t text_prefix(std::string_view bytes) {
  std::size_t done = 0;
  while (done < bytes.size() && !is_foreign(bytes[done])) {
    const std::size_t length = character_length(bytes.substr(done));
    if (length == 0) break;
    done += length;
  }
  return done;
}

std::string in_quotes(std::string_view text) {
  return fmt::format("'{}'", shortened(text));
}

std::string_view near_word(std::string_view word, const std::vector<std::string_view>& known) {
  return word.size() < 2 ? std::string_view{} : nearest_word(word, known);
}

std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& known) {
  const std::string_view near = near_word(word, known);
  return near.empty() ? std::string{} : fmt::format("; did you mean {}?", in_quotes(near));
}

void TextReport::add(Severity severity, Kind kind, const Spot& spot, std::string text) {
  Message message = selvage::error(
      kind, std::move(text), {.file = source_.name(), .place = spot.place(), .yarn = made_readable(yarn_)});
  message.severity = severity;
  add_excerpt(message, spot, source_.bytes());
  messages_.push_back(std::move(message));
}

std::nullopt_t TextReport::error(const Spot& spot, std::string text, Kind kind) {
  if (is_full()) return std::nullopt;
  ++errors_;
  add(Severity::error, kind, spot, std::move(text));
  return std::nullopt;
}

void TextReport::warning(const Spot& spot, std::string text) {
  if (++warnings_ <= most_warnings) add(Severity::warning, Kind::malformed, spot, std::move(text));
}

void TextReport::note(const Spot& spot, std::string text) {
  add(Severity::note, Kind::malformed, spot, std::move(text));
}

void TextReport::hand_over(Diagnostics& diagnostics) {
  std::stable_sort(messages_.begin(), messages_.end(), [](const Message& a, const Message& b) {
    return a.place.line != b.place.line ? a.place.line < b.place.line : a.place.column < b.place.column;
  });
  for (Message& message : messages_) diagnostics.add(std::move(message));
  messages_.clear();
  if (warnings_ <= most_warnings) return;
  diagnostics.add(selvage::warning(
      Kind::malformed, fmt::format("{} more warnings", warnings_ - most_warnings), {.file = source_.name()}));
}

}  // namespace selvage
