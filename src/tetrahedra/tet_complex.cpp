#include "tetrahedra/tet_complex.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace selvage::fem {

double tet_quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 ab = b - a, ac = c - a, ad = d - a;
  std::array<Vec3, 4> normals;  // outward, of the side opposite each corner
  normals[3] = ac.cross(ab);
  normals[2] = ab.cross(ad);
  normals[1] = ad.cross(ac);
  if (!(normals[3].dot(ad) < 0)) return inverted_quality;
  normals[0] = -(normals[1] + normals[2] + normals[3]);
  std::array<double, 4> squares{};
  for (std::size_t i = 0; i < 4; ++i) squares[i] = normals[i].squaredNorm();
  double least = 1;  // of signed squares of cosines
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double dot = normals[i].dot(normals[j]);
      least = std::min(least, dot * std::abs(dot) / (squares[i] * squares[j]));
    }
  if (!(least <= 1)) return inverted_quality;
  return least < 0 ? -std::sqrt(-least) : std::sqrt(least);
}

double angle_of_quality(double quality) {
  return quality <= -1 ? 0 : std::acos(std::clamp(-quality, -1.0, 1.0)) * 180 / std::numbers::pi;
}

double quality_of_angle(double degrees) {
  return -std::cos(degrees * std::numbers::pi / 180);
}

TetComplex::TetComplex(std::vector<Vec3> all_points, std::span<const Tetrahedron> cells,
                       std::size_t fixed_points)
    : points(std::move(all_points)) {
  cells_.resize(cells.size());
  cell_at_.assign(points.size(), none);
  fixed_.assign(points.size(), 0);
  std::fill_n(fixed_.begin(), std::min(fixed_points, points.size()), std::uint8_t{1});
  for (std::size_t c = 0; c < cells.size(); ++c) {
    cells_[c] = {.corners = cells[c], .beside = {none, none, none, none}};
    for (const std::uint32_t corner : cells[c]) cell_at_[corner] = static_cast<std::uint32_t>(c);
  }
  seen_.assign(cells_.size(), 0);
  connect_sides(sorted_sides(cells, points.size()));
  mark_walls();
}

void TetComplex::connect_sides(const std::vector<CellSide>& sorted) {
  for (std::size_t k = 0; k + 1 < sorted.size(); ++k) {
    const CellSide &a = sorted[k], &b = sorted[k + 1];
    if (a.corners != b.corners) continue;
    cells_[a.cell].beside[a.slot] = b.cell;
    cells_[b.cell].beside[b.slot] = a.cell;
  }
}

void TetComplex::mark_walls() {
  for (const Cell& cell : cells_)
    for (std::size_t slot = 0; slot < 4; ++slot) {
      if (cell.beside[slot] != none) continue;
      for (const std::size_t k : opposite_sides[slot]) fixed_[cell.corners[k]] = 1;
    }
}

void TetComplex::star(std::uint32_t point, std::vector<std::uint32_t>& found) const {
  found.clear();
  if (cell_at_[point] == none) return;
  ++walk_;
  found.push_back(cell_at_[point]);
  seen_[found.front()] = walk_;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Cell& cell = cells_[found[k]];
    for (std::size_t slot = 0; slot < 4; ++slot) {
      const std::uint32_t next = cell.beside[slot];
      if (cell.corners[slot] == point || next == none || seen_[next] == walk_) continue;
      seen_[next] = walk_;
      found.push_back(next);
    }
  }
}

bool TetComplex::ring(std::uint32_t first, std::size_t edge, std::size_t most, Ring& ring) const {
  const auto slot_of = [this](std::uint32_t c, std::uint32_t corner) {
    const Tetrahedron& t = cells_[c].corners;
    return static_cast<std::size_t>(std::find(t.begin(), t.end(), corner) - t.begin());
  };
  const auto& order = edge_corners[edge];
  const Tetrahedron& t = cells_[first].corners;
  ring.from = t[order[0]];
  ring.to = t[order[1]];
  ring.around = {t[order[2]], t[order[3]]};
  ring.cells = {first};
  ring.closed = false;
  // The corner of a cell that is neither on the edge nor `known`.
  const auto other = [&](std::uint32_t c, std::uint32_t known) {
    for (const std::uint32_t corner : cells_[c].corners)
      if (corner != ring.from && corner != ring.to && corner != known) return corner;
    return none;
  };
  for (;;) {
    const std::uint32_t behind = ring.around[ring.around.size() - 2];
    const std::uint32_t next = cells_[ring.cells.back()].beside[slot_of(ring.cells.back(), behind)];
    if (next == none) break;
    if (next == first) {
      ring.around.pop_back();
      ring.closed = true;
      return true;
    }
    ring.around.push_back(other(next, ring.around.back()));
    ring.cells.push_back(next);
    if (ring.cells.size() > most) return false;
  }
  // A wall: the other way round from the first cell.
  for (;;) {
    const std::uint32_t next = cells_[ring.cells.front()].beside[slot_of(ring.cells.front(), ring.around[1])];
    if (next == none) return true;
    ring.around.insert(ring.around.begin(), other(next, ring.around.front()));
    ring.cells.insert(ring.cells.begin(), next);
    if (ring.cells.size() > most) return false;
  }
}

std::uint32_t TetComplex::add_point(const Vec3& at) {
  points.push_back(at);
  cell_at_.push_back(none);
  fixed_.push_back(0);
  return static_cast<std::uint32_t>(points.size() - 1);
}

void TetComplex::take_out(std::span<const std::uint32_t> cells) {
  for (const std::uint32_t c : cells) {
    for (const std::uint32_t corner : cells_[c].corners) cell_at_[corner] = none;
    cells_[c].corners[0] = none;
    free_.push_back(c);
  }
}

std::uint32_t TetComplex::new_cell() {
  if (free_.empty()) {
    cells_.emplace_back();
    seen_.push_back(0);
    return static_cast<std::uint32_t>(cells_.size() - 1);
  }
  const std::uint32_t c = free_.back();
  free_.pop_back();
  return c;
}

// Of a point round a cavity, in the order in which they are met.
std::size_t TetComplex::local_number(std::uint32_t point) {
  if (local_.size() < points.size()) local_.resize(std::max(points.size(), 2 * local_.size()), 0);
  const std::uint32_t known = local_[point];
  if (known < locals_.size() && locals_[known] == point) return known;
  local_[point] = static_cast<std::uint32_t>(locals_.size());
  locals_.push_back(point);
  return locals_.size() - 1;
}

void TetComplex::replace_by_star(std::span<const std::uint32_t> old_cells, std::span<const Side> sides,
                                 std::uint32_t point, std::vector<std::uint32_t>& added) {
  beyond_.clear();
  for (const Side& side : sides) {
    const Cell& cell = cells_[side.cell];
    const auto& k = opposite_sides[side.slot];
    const std::uint32_t out = cell.beside[side.slot];
    std::uint32_t there = 0;
    while (out != none && cells_[out].beside[there] != side.cell) ++there;
    beyond_.push_back({{cell.corners[k[0]], cell.corners[k[1]], cell.corners[k[2]]}, {out, there}});
  }
  take_out(old_cells);
  added.clear();
  locals_.clear();
  const std::size_t most = sides.size() + 2;  // points: half as many as sides, and two, where it is one ball
  half_edges_.resize(most * most);
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const auto& [corners, side] = beyond_[k];
    const std::uint32_t c = new_cell();
    cells_[c] = {.corners = {point, corners[0], corners[1], corners[2]},
                 .beside = {side.cell, none, none, none},
                 .quality = 0};
    if (side.cell != none) cells_[side.cell].beside[side.slot] = c;
    added.push_back(c);
    for (const std::uint32_t corner : corners) cell_at_[corner] = c;
    // Two of the new cells share the side over each edge, through which they run opposite ways.
    std::array<std::size_t, 3> local{};
    for (std::size_t j = 0; j < 3; ++j) local[j] = local_number(corners[j]);
    for (std::size_t j = 0; j < 3; ++j)
      half_edges_[local[(j + 1) % 3] * most + local[(j + 2) % 3]] = static_cast<std::uint32_t>(3 * k + j);
  }
  cell_at_[point] = added.front();
  for (std::size_t k = 0; k < sides.size(); ++k)
    for (std::size_t j = 0; j < 3; ++j) {
      const TetFace& corners = beyond_[k].corners;
      const std::size_t from = local_[corners[(j + 1) % 3]], to = local_[corners[(j + 2) % 3]];
      cells_[added[k]].beside[j + 1] = added[half_edges_[to * most + from] / 3];
    }
}

void TetComplex::replace(std::span<const std::uint32_t> old_cells, std::span<const Tetrahedron> new_cells,
                         std::vector<std::uint32_t>& added) {
  open_.clear();
  ++walk_;
  for (const std::uint32_t c : old_cells) seen_[c] = walk_;
  // What is left open outside, named by the neighbour's side.
  for (const std::uint32_t c : old_cells)
    for (std::uint32_t slot = 0; slot < 4; ++slot) {
      const std::uint32_t out = cells_[c].beside[slot];
      if (out == none || seen_[out] == walk_) continue;
      const auto& back = cells_[out].beside;
      open_.push_back(side_of(cells_[c].corners, out, slot));
      open_.back().slot = static_cast<std::uint32_t>(std::find(back.begin(), back.end(), c) - back.begin());
    }
  take_out(old_cells);
  added.clear();
  for (const Tetrahedron& t : new_cells) {
    const std::uint32_t c = new_cell();
    cells_[c] = {.corners = t, .beside = {none, none, none, none}, .quality = quality(t)};
    added.push_back(c);
    for (std::uint32_t slot = 0; slot < 4; ++slot) open_.push_back(side_of(t, c, slot));
    for (const std::uint32_t corner : t) cell_at_[corner] = c;
  }
  std::sort(open_.begin(), open_.end(), [](const CellSide& a, const CellSide& b) {
    return a.corners != b.corners ? a.corners < b.corners : a.cell < b.cell;
  });
  connect_sides(open_);
}

void TetComplex::measure_all() {
  for (Cell& cell : cells_)
    if (cell.corners[0] != none) cell.quality = quality(cell.corners);
}

void TetComplex::measure_star(std::uint32_t point) {
  std::vector<std::uint32_t> cells;
  star(point, cells);
  for (const std::uint32_t c : cells) cells_[c].quality = quality(cells_[c].corners);
}

}  // namespace selvage::fem
