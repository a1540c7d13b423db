// Text of others (names of files and yarns, titles) as a person can read it on a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace selvage {

// The length of the UTF-8 character at the front of `bytes`, which are not empty (RFC 3629); 0 where there is
// none.
std::size_t character_length(std::string_view bytes);

// Whether that character, of character_length() bytes, would steer a terminal or turn text around instead of
// being seen: control characters (of C0, tab and newline too, and C1), marks of direction, separators of
// lines.
bool is_control(std::string_view character);

// Controls, and bytes that are no UTF-8, as \n, \t, \x1B, \u202E; the rest as it is. What is readable stays
// as it is.
std::string readable(std::string_view text);

// The same, of what is longer than `most` characters the beginning and "...": at most that many. `most` >= 3.
std::string shortened(std::string_view text, std::size_t most = 48);

// How many characters: the columns that they take, for alphabets of one column each.
std::size_t columns_of(std::string_view text);

}  // namespace selvage
