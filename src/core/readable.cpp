#include "core/readable.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage {

namespace {

std::string escaped(char32_t code) {
  if (code == '\n') return "\\n";
  if (code == '\t') return "\\t";
  if (code == '\r') return "\\r";
  return code <= 0xFF ? fmt::format("\\x{:02X}", static_cast<unsigned>(code))
                      : fmt::format("\\u{:04X}", static_cast<unsigned>(code));
}

}  // namespace

std::size_t character_length(std::string_view bytes) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || bytes.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if (!is_continuation(bytes[i])) return 0;
  const unsigned char second = byte(1);
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool beyond = (first == 0xED && second > 0x9F) || (first == 0xF4 && second > 0x8F);
  return overlong || beyond ? 0 : length;
}

char32_t Character::code() const {
  const auto first = static_cast<unsigned char>(bytes.front());
  char32_t code = bytes.size() == 1 ? first : first & (0x7FU >> bytes.size());
  for (char c : bytes.substr(1)) code = code << 6U | (static_cast<unsigned char>(c) & 0x3FU);
  return code;
}

Character take_character(std::string_view& text) {
  const std::size_t length = character_length(text);
  const Character taken{text.substr(0, std::max<std::size_t>(length, 1)), length > 0};
  text.remove_prefix(taken.bytes.size());
  return taken;
}

bool is_control(char32_t code) {
  const auto in = [code](char32_t from, char32_t to) { return code >= from && code <= to; };
  return code < 0x20 || in(0x7F, 0x9F) || code == 0x61C || in(0x200E, 0x200F) || in(0x2028, 0x202E) ||
         in(0x2066, 0x2069);
}

std::string readable(std::string_view text) {
  std::string shown;
  shown.reserve(text.size());
  while (!text.empty()) {
    const auto odd = std::find_if(text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; });
    const auto plain = static_cast<std::size_t>(odd - text.begin());
    shown += text.substr(0, plain);
    text.remove_prefix(plain);
    if (text.empty()) break;
    const Character character = take_character(text);
    if (!character.is_valid)
      shown += escaped(static_cast<unsigned char>(character.bytes.front()));
    else if (is_control(character.code()))
      shown += escaped(character.code());
    else
      shown += character.bytes;
  }
  return shown;
}

std::string shortened(std::string_view text, std::size_t most) {
  // Only so much is looked at as may be shown: a character has at most four bytes.
  std::string shown = readable(text.substr(0, 4 * (most + 1)));
  if (columns_of(shown) <= most) return shown;
  std::size_t end = 0;
  for (std::size_t columns = 0; columns + 3 < most; ++columns) do
      ++end;
    while (is_continuation(shown[end]));
  shown.resize(end);
  return shown + "...";
}

std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return !is_continuation(c); }));
}

}  // namespace selvage
