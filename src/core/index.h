// Signed counts and indices of numerics, as indices of containers.
#pragma once

#include <concepts>
#include <cstddef>

namespace selvage {

// `i` is not negative.
template <std::signed_integral Index>
constexpr std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

}  // namespace selvage
