// Text of others (names of files and yarns, titles) as a person can read it on a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace selvage {

// A byte of a UTF-8 character that is not its first.
constexpr bool is_continuation(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U;
}

// The length of the UTF-8 character at the front of `bytes`, which are not empty (RFC 3629); 0 where there is
// none.
std::size_t character_length(std::string_view bytes);

// A UTF-8 character, or a byte that is none.
struct Character {
  std::string_view bytes;
  bool is_valid = false;
  [[nodiscard]] char32_t code() const;  // of a valid one
};
// The one at the front of `text`, which is not empty, taken off it.
Character take_character(std::string_view& text);

// Whether a character would steer a terminal or turn text around instead of being seen: control characters
// (of C0, tab and newline too, and C1), marks of direction, separators of lines.
bool is_control(char32_t code);

// Controls, and bytes that are no UTF-8, as \n, \t, \x1B, \u202E; the rest as it is. What is readable stays
// as it is.
std::string readable(std::string_view text);

// The same, of what is longer than `most` characters the beginning and "...": at most that many. `most` >= 3.
std::string shortened(std::string_view text, std::size_t most = 48);

// How many characters: the columns that they take, for alphabets of one column each.
std::size_t columns_of(std::string_view text);

}  // namespace selvage
