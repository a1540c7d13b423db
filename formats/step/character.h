// Characters of texts, which Part 21 writes in a form of its own.
#pragma once

#include <string_view>

#include "core/readable.h"

namespace selvage::formats::step {

// The code of the first character of a text in UTF-8, taken off it; a byte that is none stands for itself
// (Latin-1).
inline char32_t take_code(std::string_view& text) {
  const Character character = take_character(text);
  return character.is_valid ? character.code() : static_cast<unsigned char>(character.bytes.front());
}

}  // namespace selvage::formats::step
