#include "core/text_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>

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
void add_excerpt(Message& message, const Spot& spot, std::string_view bytes) {
  const char* const end = bytes.data() + bytes.size();
  const char* from = spot.at - (spot.column - 1);
  const auto room = static_cast<std::size_t>(end - spot.at);
  const void* newline = room > 0 ? std::memchr(spot.at, '\n', std::min(room, 2 * excerpt_after)) : nullptr;
  const bool goes_on = newline == nullptr && room > 2 * excerpt_after;
  const char* to = newline != nullptr ? static_cast<const char*>(newline)
                   : goes_on          ? spot.at + excerpt_after
                                      : end;
  if (!goes_on && to > from && to[-1] == '\r') --to;
  std::string before, after;
  if (static_cast<std::size_t>(spot.at - from) > 2 * excerpt_before) {
    from = spot.at - excerpt_before;
    while (from < spot.at && is_continuation(*from)) ++from;
    before = "...";
  }
  if (goes_on) {
    while (to > spot.at && is_continuation(*to)) --to;
    after = "...";
  }
  to = std::max(to, from);
  const auto caret_at = static_cast<std::size_t>(std::min(spot.at, to) - from);
  const std::string_view line(from, static_cast<std::size_t>(to - from));
  const std::string left = before + made_readable(line.substr(0, caret_at));
  message.excerpt = left + made_readable(line.substr(caret_at)) + after;
  if (!message.excerpt.empty()) message.caret = static_cast<int>(left.size()) + 1;
}

// Without what may be words of the text, which stand in quotes: a quote within them ends nothing.
std::string without_quoted(const std::string& text) {
  std::size_t begin = text.find('\'');
  // An apostrophe follows a letter.
  while (begin != text.npos && begin > 0 && std::isalnum(static_cast<unsigned char>(text[begin - 1])) != 0)
    begin = text.find('\'', begin + 1);
  if (begin == text.npos) return text;
  return text.substr(0, begin) + "'...'" + text.substr(text.rfind('\'') + 1);
}

}  // namespace

Spot spot_at(const Source& source, TextPlace place) {
  std::string_view rest = source.bytes();
  for (int line = 1; line < place.line; ++line) {
    const std::size_t newline = rest.find('\n');
    if (newline == std::string_view::npos)
      return {rest.data() + rest.size(), line, static_cast<int>(rest.size()) + 1};
    rest.remove_prefix(newline + 1);
  }
  const auto column =
      std::clamp<std::size_t>(static_cast<std::size_t>(std::max(place.column, 1)), 1, rest.size() + 1);
  return {rest.data() + column - 1, std::max(place.line, 1), static_cast<int>(column)};
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
  Message message = selvage::error(kind, std::move(text), {.file = source_.name(), .place = spot.place()});
  message.severity = severity;
  if (source_.may_be_quoted()) {
    message.yarn = made_readable(yarn_);
    add_excerpt(message, spot, source_.bytes());
  } else {
    message.text = without_quoted(message.text);
  }
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
