// Strings of Part 21 (ISO 10303-21).
#pragma once

#include <string>
#include <string_view>

namespace selvage::formats::step {

// A Part 21 string without its quotes as UTF-8: doubled quotes and backslashes, \X\, \S\, \X2\ and \X4\.
// Bytes from 0x80 are kept where they are UTF-8, else taken for Latin-1; control characters become '_'.
std::string decoded(std::string_view text);

}  // namespace selvage::formats::step
