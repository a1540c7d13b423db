// Numbers as text: the shortest decimal form that reads back to the same bits, and its exact inverse.
#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace selvage {

// Room that is always enough for one number written by write_number.
inline constexpr std::size_t max_number_length = 32;

// Writes the shortest form of a finite `value` at `out` (at least max_number_length bytes) and returns the
// end: the very characters of std::to_chars, in less than its time (digits by Junekey Jeon's Dragonbox as
// {fmt} has it).
char* write_number(char* out, double value);
// The shortest form that reads back to the same float.
inline char* write_number(char* out, float value) {
  return std::to_chars(out, out + max_number_length, value).ptr;
}
inline char* write_number(char* out, long long value) {
  return std::to_chars(out, out + max_number_length, value).ptr;
}

inline std::string number_text(double value) {
  char buffer[max_number_length];
  return {buffer, write_number(buffer, value)};
}

// The number that the whole text is: what std::from_chars takes, with an optional leading '+'. Nothing for
// any other text, for infinities and nan, and for a number that is out of a double's range.
std::optional<double> read_number(std::string_view text);

}  // namespace selvage
