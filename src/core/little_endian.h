// Numbers as binary files have them: their bytes, the least significant one first, on every machine.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <string_view>
#include <type_traits>

namespace selvage {

// `to` takes bytes by append(): a std::string, a TextBuffer.
template <class To, class Number>
requires std::is_arithmetic_v<Number>
void append_little_endian(To& to, Number value) {
  auto bytes = std::bit_cast<std::array<char, sizeof(Number)>>(value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
  to.append(std::string_view(bytes.data(), bytes.size()));
}

}  // namespace selvage
