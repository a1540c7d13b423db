// Characters of texts, which Part 21 writes in a form of its own.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "core/readable.h"

namespace selvage::formats::step {

// The first character of a text in UTF-8, taken off it; a byte that is none stands for itself (Latin-1).
inline char32_t take_character(std::string_view& text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::size_t length = character_length(text);
  char32_t code = length > 1 ? byte(0) & (0xFFU >> (length + 1)) : byte(0);
  for (std::size_t i = 1; i < length; ++i) code = code << 6U | (byte(i) & 0x3FU);
  text.remove_prefix(std::max<std::size_t>(length, 1));
  return code;
}

}  // namespace selvage::formats::step
