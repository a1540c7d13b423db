// Words in texts: lists of them with separators, letters of any case, plurals.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace selvage {

// ASCII only, whatever the locale.
constexpr char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
// Equal but for the case of letters.
constexpr bool same_word(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return lower(x) == lower(y); });
}

// Without the blanks, tabs and line ends at both ends.
std::string_view trimmed(std::string_view text);

// What stands between separators; behind a last one stands nothing.
std::vector<std::string_view> split(std::string_view text, char separator);
// What stands between blanks, or between other separators, and is not empty.
std::vector<std::string_view> words_of(std::string_view text, char separator = ' ');

// "a, b or c".
std::string alternatives(const std::vector<std::string_view>& words);

// "1 yarn", "2 yarns".
std::string counted(std::size_t count, std::string_view noun);

}  // namespace selvage
