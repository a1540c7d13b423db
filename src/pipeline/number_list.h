// Numbers in one word of the command line: "1200x900", "0/4".
#pragma once

#include <array>
#include <charconv>
#include <optional>
#include <string_view>

namespace selvage::pipeline {

// Whole numbers between `separator`s, each within [low, high]: exactly as many as the array holds.
template <std::size_t Count>
std::optional<std::array<int, Count>> numbers(std::string_view text, char separator, int low, int high) {
  std::array<int, Count> values{};
  const char *at = text.data(), *end = at + text.size();
  for (std::size_t k = 0; k < Count; ++k) {
    if (k > 0 && (at == end || *at++ != separator)) return std::nullopt;
    const auto [rest, failure] = std::from_chars(at, end, values[k]);
    if (failure != std::errc() || values[k] < low || values[k] > high) return std::nullopt;
    at = rest;
  }
  if (at != end) return std::nullopt;
  return values;
}

}  // namespace selvage::pipeline
