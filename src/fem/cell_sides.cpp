#include "fem/cell_sides.h"

#include <algorithm>
#include <tuple>

namespace selvage::fem {

CellSide side_of(const std::array<std::uint32_t, 4>& cell, std::uint32_t number, std::uint32_t slot) {
  const auto& k = opposite_sides[slot];
  CellSide side{{cell[k[0]], cell[k[1]], cell[k[2]]}, number, slot, true};
  const auto order = [&side](std::size_t i, std::size_t j) {
    if (side.corners[i] < side.corners[j]) return;
    std::swap(side.corners[i], side.corners[j]);
    side.even = !side.even;
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  return side;
}

// Into buckets by the smallest corner; each bucket is short.
std::vector<CellSide> sorted_sides(std::span<const std::array<std::uint32_t, 4>> cells, std::size_t points) {
  std::vector<std::uint32_t> begin(points + 1, 0);
  for (const auto& cell : cells)
    for (const auto& k : opposite_sides) ++begin[std::min({cell[k[0]], cell[k[1]], cell[k[2]]}) + 1];
  for (std::size_t p = 0; p < points; ++p) begin[p + 1] += begin[p];
  std::vector<CellSide> sides(4 * cells.size());
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (std::uint32_t c = 0; c < cells.size(); ++c)
    for (std::uint32_t slot = 0; slot < 4; ++slot) {
      const CellSide side = side_of(cells[c], c, slot);
      sides[next[side.corners[0]]++] = side;
    }
  const auto key = [](const CellSide& side) {
    return std::pair(std::uint64_t{side.corners[1]} << 32U | side.corners[2], side.cell);
  };
  for (std::size_t p = 0; p < points; ++p)
    std::sort(sides.begin() + begin[p], sides.begin() + begin[p + 1],
              [key](const CellSide& a, const CellSide& b) { return key(a) < key(b); });
  return sides;
}

}  // namespace selvage::fem
