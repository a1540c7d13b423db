// The edges of a mesh by number.
#pragma once

#include <algorithm>
#include <cstdint>

namespace selvage::fem {

// Of an edge between two nodes (< 2^32), whichever comes first: the lesser one in the upper 32 bits.
inline std::uint64_t edge_key(std::uint64_t a, std::uint64_t b) {
  return std::min(a, b) << 32U | std::max(a, b);
}

}  // namespace selvage::fem
