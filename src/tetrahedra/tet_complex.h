// Tetrahedra that know their neighbours, and can be exchanged for others: what improve() works on.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/vec.h"
#include "fem/cell_sides.h"

namespace selvage::fem {

using Tetrahedron = std::array<std::uint32_t, 4>;  // positive volume: ((p1-p0) x (p2-p0)) . (p3-p0) > 0
using TetFace = std::array<std::uint32_t, 3>;

// Minus the cosine of the smallest dihedral angle: it increases with the angle, from -1 (flat) to -1/3 (the
// regular tetrahedron). `inverted_quality` where the volume is not positive.
inline constexpr double inverted_quality = -2;
double tet_quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
double angle_of_quality(double quality);  // degrees
double quality_of_angle(double degrees);

// The corners of each edge, and the other two: (first, second, third, fourth) is an even permutation.
inline constexpr std::array<std::array<std::size_t, 4>, 6> edge_corners = {
    {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}}};

class TetComplex {
 public:
  static constexpr std::uint32_t none = 0xffffffffU;

  struct Cell {
    Tetrahedron corners;                  // corners[0] == none: taken out
    std::array<std::uint32_t, 4> beside;  // the cell over the side opposite each corner; none: a wall
    double quality = 0;                   // tet_quality, where it was measured
  };

  // Of one region: a wall is a side that only one cell has. Cells are not measured yet (measure_all).
  TetComplex(std::vector<Vec3> points, std::span<const Tetrahedron> cells, std::size_t fixed_points);

  std::vector<Vec3> points;
  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }
  [[nodiscard]] const Cell& cell(std::uint32_t c) const { return cells_[c]; }
  [[nodiscard]] bool is_alive(std::uint32_t c) const { return cells_[c].corners[0] != none; }
  [[nodiscard]] bool is_fixed(std::uint32_t point) const { return fixed_[point] != 0; }
  [[nodiscard]] double quality(const Tetrahedron& t) const {
    return tet_quality(points[t[0]], points[t[1]], points[t[2]], points[t[3]]);
  }

  // All cells at an inner point (none of whose sides at it is a wall).
  void star(std::uint32_t point, std::vector<std::uint32_t>& cells) const;

  // The cells round an edge: cell k has the corners from, to, around[k], around[k + 1]
  // (positive). Closed: after the last comes around[0] again; else it begins and ends at walls.
  struct Ring {
    std::uint32_t from = 0, to = 0;
    bool closed = false;
    std::vector<std::uint32_t> around, cells;
  };
  // False: more than `most` cells.
  bool ring(std::uint32_t cell, std::size_t edge, std::size_t most, Ring& ring) const;

  std::uint32_t add_point(const Vec3& at);
  // Takes cells out and puts others into the same space. `added` receives their numbers.
  void replace(std::span<const std::uint32_t> old_cells, std::span<const Tetrahedron> new_cells,
               std::vector<std::uint32_t>& added);
  // A side of a cell, opposite the corner in `slot`.
  struct Side {
    std::uint32_t cell, slot;
  };
  // Takes cells out whose outer sides are `sides`, and joins these to a point inside: `added`
  // receives as many cells, in their order, which are not measured.
  void replace_by_star(std::span<const std::uint32_t> old_cells, std::span<const Side> sides,
                       std::uint32_t point, std::vector<std::uint32_t>& added);
  void measure_all();
  // The point has been moved: measures its star again.
  void measure_star(std::uint32_t point);

 private:
  // What is on the other side of a cavity's side: `slot` is its own there; no cell: a wall.
  struct Beyond {
    TetFace corners;  // counter-clockwise seen from outside of the cavity
    Side side;
  };
  void connect_sides(const std::vector<CellSide>& sorted);  // of the same corners
  void mark_walls();
  void take_out(std::span<const std::uint32_t> cells);
  std::uint32_t new_cell();
  std::size_t local_number(std::uint32_t point);

  std::vector<Cell> cells_;
  std::vector<std::uint32_t> free_;
  std::vector<std::uint32_t> cell_at_;  // of each point, one of its cells
  std::vector<std::uint8_t> fixed_;
  mutable std::vector<std::uint32_t> seen_;  // of each cell: the last walk that met it
  mutable std::uint32_t walk_ = 0;
  std::vector<CellSide> open_;
  std::vector<Beyond> beyond_;
  std::vector<std::uint32_t> local_, locals_;  // numbers of the points round a cavity, and those points
  std::vector<std::uint32_t>
      half_edges_;  // of two such points: the side that has the edge from one to the other
};

}  // namespace selvage::fem
