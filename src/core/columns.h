// Text in columns of fixed width, as solvers' decks have it.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <span>
#include <string>

#include "core/text_buffer.h"

namespace selvage {

// In at most `width` characters (10 or more), for columns of that width: the shortest exact form where it is
// that short, else rounded to the digits that fit.
inline std::string number_text(double value, std::size_t width) {
  char buffer[max_number_length + 1];
  char* end = write_number(buffer, value);
  for (int digits = 16; static_cast<std::size_t>(end - buffer) > width && digits > 0; --digits)
    end = std::to_chars(buffer, buffer + max_number_length, value, std::chars_format::general, digits).ptr;
  return {buffer, end};
}

// Right-justified. What is wider than its column goes in whole: check the largest before.
inline void put_right(TextBuffer& text, std::string_view word, std::size_t width) {
  for (std::size_t k = word.size(); k < width; ++k) text << ' ';
  text << word;
}
inline void put_left(TextBuffer& text, std::string_view word, std::size_t width) {
  text << word;
  for (std::size_t k = word.size(); k < width; ++k) text << ' ';
}
inline void put_right(TextBuffer& text, std::size_t value, std::size_t width) {
  char digits[max_number_length];
  const char* end = write_number(digits, static_cast<long long>(value));
  put_right(text, std::string_view(digits, static_cast<std::size_t>(end - digits)), width);
}

inline void put_right(TextBuffer& text, std::initializer_list<std::size_t> values, std::size_t width) {
  for (const std::size_t value : values) put_right(text, value, width);
}
// Lines of `per_line` numbers each, those of things that are counted from 0 here and from 1 in the file.
inline void put_numbers(TextBuffer& text, std::span<const std::size_t> indices, std::size_t width,
                        std::size_t per_line) {
  for (std::size_t k = 0; k < indices.size(); ++k) {
    put_right(text, indices[k] + 1, width);
    if (k % per_line == per_line - 1 || k + 1 == indices.size()) text << '\n';
  }
}

// Fortran's Ew.dE3 with one digit before the point: `digits` after it, three of the exponent; digits + 8
// characters with a sign.
inline std::string scientific_text(double value, int digits, char letter = 'E') {
  char buffer[max_number_length + 8];
  const char* end =
      std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::scientific, digits).ptr;
  const std::string_view whole(buffer, static_cast<std::size_t>(end - buffer));
  const std::size_t cut = whole.find('e') + 2;  // behind the exponent's sign
  std::string number(whole.substr(0, cut));
  number[cut - 2] = letter;
  number.append(3 - std::min<std::size_t>(3, whole.size() - cut), '0');
  number += whole.substr(cut);
  return number;
}

}  // namespace selvage
