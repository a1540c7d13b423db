#include "cad/places.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace selvage::cad {

namespace {

Box3 box_of(const Polylines& outline) {
  Box3 box;
  for (const std::vector<Vec3>& line : outline)
    for (const Vec3& p : line) box.extend(p);
  return box;
}

int level_of(double size) {
  return size > 0 ? std::ilogb(size) : -1100;
}

// Cells of a level have the edge 2^level. Distant coordinates and levels share keys: the boxes are compared.
std::uint64_t key_of(int level, const std::array<double, 3>& cell) {
  auto key = static_cast<std::uint64_t>(level + 4096);
  for (const double x : cell) {
    key = (key ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9E3779B97F4A7C15U;
    key ^= key >> 29U;
  }
  return key;
}

}  // namespace

void Places::add(const Polylines& outline, std::size_t id) {
  const Box3 box = box_of(outline);
  const int level = level_of(box.diagonal().norm());
  const double edge = std::ldexp(1.0, level);
  std::array<double, 3> cell{};
  for (int k = 0; k < 3; ++k) cell[static_cast<std::size_t>(k)] = std::floor(box.center()[k] / edge);
  cells_[key_of(level, cell)].push_back({box, id});
}

std::vector<std::size_t> Places::near(const Polylines& outline) const {
  const Box3 box = box_of(outline);
  const double size = box.diagonal().norm(), reach = 0.25 * size;
  std::vector<std::size_t> ids;
  const auto look = [&](int level, const std::array<double, 3>& cell) {
    const auto found = cells_.find(key_of(level, cell));
    if (found == cells_.end()) return;
    for (const Entry& entry : found->second)
      if ((entry.box.center() - box.center()).norm() <= reach) ids.push_back(entry.id);
  };
  for (int level = level_of(size) - 1; level <= level_of(size) + 1; ++level) {
    const double edge = std::ldexp(1.0, level);
    std::array<double, 3> low{}, high{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double centre = box.center()[static_cast<Eigen::Index>(k)];
      low[k] = std::floor((centre - reach) / edge);
      high[k] = std::floor((centre + reach) / edge);
    }
    // At most three cells a direction; far from the origin low may be high already.
    const auto at = [&](std::size_t k, int step) { return std::min(low[k] + step, high[k]); };
    for (int a = 0; a < 3 && (a == 0 || at(0, a) > at(0, a - 1)); ++a)
      for (int b = 0; b < 3 && (b == 0 || at(1, b) > at(1, b - 1)); ++b)
        for (int c = 0; c < 3 && (c == 0 || at(2, c) > at(2, c - 1)); ++c)
          look(level, {at(0, a), at(1, b), at(2, c)});
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

}  // namespace selvage::cad
