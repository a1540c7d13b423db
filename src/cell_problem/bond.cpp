#include "cell_problem/bond.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "fem/cell_sides.h"

namespace selvage::fem {
namespace {

using Cell = std::array<std::uint32_t, 4>;

// The two yarns between which a point inside of a gap lies, the nearer first.
struct Between {
  std::uint32_t near = no_yarn, far = no_yarn;
  double near_way = std::numeric_limits<double>::infinity(), far_way = near_way;

  void offer(std::uint32_t yarn, double way) {
    if (yarn == near) {
      near_way = std::min(near_way, way);
    } else if (way < near_way) {
      far = near;
      far_way = near_way;
      near = yarn;
      near_way = way;
    } else if (yarn == far) {
      far_way = std::min(far_way, way);
    } else if (way < far_way) {
      far = yarn;
      far_way = way;
    }
  }
};

class Gaps {
 public:
  Gaps(std::span<const Vec3> points, std::span<const Cell> cells, std::span<const std::uint32_t> yarns,
       std::uint32_t matrix, double reach, const std::vector<std::uint32_t>& regions)
      : points_(points), yarns_(yarns), reach_(reach), between_(points.size()) {
    // Inner points, by the shortest of their edges to each yarn.
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (regions[c] != matrix) continue;
      for (const std::uint32_t p : cells[c])
        for (const std::uint32_t q : cells[c])
          if (yarns[p] == no_yarn && yarns[q] != no_yarn)
            between_[p].offer(yarns[q], (points[p] - points[q]).norm());
    }
  }

  // The yarn that gets the cell; none: it does not lie in a gap.
  [[nodiscard]] std::optional<std::uint32_t> owner(const Cell& cell) const {
    std::array<std::uint32_t, 4> belongs{};
    std::array<std::uint32_t, 2> pair{no_yarn, no_yarn};
    const auto note = [&](std::uint32_t yarn) {
      if (pair[0] == no_yarn || pair[0] == yarn) {
        pair[0] = yarn;
      } else if (pair[1] == no_yarn || pair[1] == yarn) {
        pair[1] = yarn;
      } else {
        return false;
      }
      return true;
    };
    bool is_all_on_yarns = true;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t p = cell[k];
      belongs[k] = yarns_[p];
      if (belongs[k] == no_yarn) {
        is_all_on_yarns = false;
        const Between& between = between_[p];
        if (!(between.near_way + between.far_way <= inner_share * reach_)) return std::nullopt;
        belongs[k] = between.near;
        if (!note(between.far)) return std::nullopt;
      }
      if (!note(belongs[k])) return std::nullopt;
    }
    if (pair[1] == no_yarn) return std::nullopt;
    if (is_all_on_yarns && !(width(cell, pair[0]) <= reach_)) return std::nullopt;
    const auto first = std::count(belongs.begin(), belongs.end(), pair[0]);
    if (first == 2) return std::min(pair[0], pair[1]);
    return first > 2 ? pair[0] : pair[1];
  }

 private:
  // Across the cell, from its corners of one yarn to those of the other: between a face and a corner or two
  // edges.
  [[nodiscard]] double width(const Cell& cell, std::uint32_t yarn) const {
    std::array<Vec3, 4> p;
    std::size_t first = 0, last = 4;
    for (const std::uint32_t corner : cell) p[yarns_[corner] == yarn ? first++ : --last] = points_[corner];
    if (first == 4) return std::numeric_limits<double>::infinity();
    const double volume = std::abs((p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]));
    Vec3 across = (p[1] - p[0]).cross(p[3] - p[2]);
    if (first == 1) across = (p[2] - p[1]).cross(p[3] - p[1]);
    if (first == 3) across = (p[1] - p[0]).cross(p[2] - p[0]);
    return across.norm() > 0 ? volume / across.norm() : 0;
  }

  // The two ways from an inner point run askew.
  static constexpr double inner_share = 3;
  std::span<const Vec3> points_;
  std::span<const std::uint32_t> yarns_;
  double reach_;
  std::vector<Between> between_;
};

double shared_area(std::span<const Vec3> points, std::span<const Cell> cells, std::uint32_t matrix,
                   const std::vector<std::uint32_t>& regions) {
  double area = 0;
  const std::vector<CellSide> sides = sorted_sides(cells, points.size());
  for (std::size_t k = 0; k + 1 < sides.size(); ++k) {
    const std::array<std::uint32_t, 3>& face = sides[k].corners;
    const std::uint32_t a = regions[sides[k].cell], b = regions[sides[k + 1].cell];
    if (sides[k + 1].corners == face && a != b && a != matrix && b != matrix)
      area += (points[face[1]] - points[face[0]]).cross(points[face[2]] - points[face[0]]).norm() / 2;
  }
  return area;
}

}  // namespace

Bonding bond_contacts(std::span<const Vec3> points, std::span<const std::array<std::uint32_t, 4>> cells,
                      std::span<const std::uint32_t> yarns, std::uint32_t matrix, double reach,
                      std::vector<std::uint32_t>& regions) {
  const Gaps gaps(points, cells, yarns, matrix, reach, regions);
  Bonding bonding;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (regions[c] != matrix) continue;
    const std::optional<std::uint32_t> owner = gaps.owner(cells[c]);
    if (!owner) continue;
    regions[c] = *owner;
    ++bonding.cells;
    bonding.volume += six_volumes(points, cells[c]) / 6;
  }
  bonding.area = shared_area(points, cells, matrix, regions);
  return bonding;
}

}  // namespace selvage::fem
