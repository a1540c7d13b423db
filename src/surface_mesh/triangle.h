// Triangles between regions, by their corners.
#pragma once

#include <array>
#include <cstdint>

namespace selvage::fem {

using Triangle = std::array<std::uint32_t, 3>;

// The regions on both sides of a triangle.
struct Sides {
  static constexpr std::uint32_t outside = static_cast<std::uint32_t>(-1);
  std::uint32_t behind = 0, front = outside;  // front: where it is seen counter-clockwise from
};

}  // namespace selvage::fem
