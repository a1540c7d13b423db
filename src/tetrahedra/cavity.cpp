#include "tetrahedra/cavity.h"

#include <algorithm>

namespace selvage::fem {
namespace {

constexpr std::size_t most_cells = 60;

}  // namespace

void CavityInsertion::add_sides(Cavity& cavity, std::uint32_t c) const {
  const TetComplex::Cell& cell = complex_.cell(c);
  for (std::size_t slot = 0; slot < 4; ++slot) {
    const std::uint32_t beside = cell.beside[slot];
    if (beside != TetComplex::none) {
      // A side of the cavity until now: inside from now on.
      const auto shared = std::find_if(cavity.sides.begin(), cavity.sides.end(), [&](const Side& side) {
        return side.cell == beside && complex_.cell(beside).beside[side.slot] == c;
      });
      if (shared != cavity.sides.end()) {
        *shared = cavity.sides.back();
        cavity.sides.pop_back();
        continue;
      }
    }
    Side side{.corners = {}, .cell = c, .slot = slot, .quality = 0};
    for (std::size_t k = 0; k < 3; ++k) side.corners[k] = cell.corners[opposite_sides[slot][k]];
    const std::vector<Vec3>& p = complex_.points;
    side.quality = tet_quality(cavity.at, p[side.corners[0]], p[side.corners[1]], p[side.corners[2]]);
    cavity.sides.push_back(side);
  }
}

bool CavityInsertion::add_cell(Cavity& cavity, std::uint32_t c) const {
  cavity.cells.push_back(c);
  cavity.replaced = std::min(cavity.replaced, complex_.cell(c).quality);
  add_sides(cavity, c);
  cavity.quality = 1;
  for (const Side& side : cavity.sides) cavity.quality = std::min(cavity.quality, side.quality);
  return cavity.cells.size() < most_cells;
}

bool CavityInsertion::start(const std::vector<std::uint32_t>& seed, const Vec3& at, Cavity& cavity) const {
  cavity = {};
  cavity.at = at;
  for (const std::uint32_t c : seed)
    if (!add_cell(cavity, c)) return false;
  return true;
}

// Over the worst side, as long as it can be crossed; what was best on the way is kept.
void CavityInsertion::grow(Cavity& cavity) const {
  Cavity best = cavity;
  for (;;) {
    const auto worst = std::min_element(cavity.sides.begin(), cavity.sides.end(),
                                        [](const Side& a, const Side& b) { return a.quality < b.quality; });
    const std::uint32_t next = complex_.cell(worst->cell).beside[worst->slot];
    if (next == TetComplex::none || !add_cell(cavity, next)) break;
    if (cavity.quality > best.quality) best = cavity;
  }
  cavity = std::move(best);
}

void CavityInsertion::place(Cavity& cavity, double goal) {
  if (cavity.quality <= inverted_quality) return;
  star_.clear();
  for (const Side& side : cavity.sides)
    star_.push_back({complex_.points[side.corners[0]], complex_.points[side.corners[1]],
                     complex_.points[side.corners[2]]});
  cavity.quality = point_place_.improve(cavity.at, star_, goal);
  for (std::size_t k = 0; k < star_.size(); ++k)
    cavity.sides[k].quality = tet_quality(cavity.at, star_[k][0], star_[k][1], star_[k][2]);
}

void CavityInsertion::attempt(const std::vector<std::uint32_t>& seed, const Vec3& at, double goal,
                              Cavity& best) {
  Cavity cavity;
  if (!start(seed, at, cavity)) return;
  for (int round = 0; round < 3 && cavity.quality < goal; ++round) {
    const double before = cavity.quality;
    grow(cavity);
    place(cavity, goal);
    if (round > 0 && cavity.quality <= before) break;
  }
  const double gain = cavity.quality - std::max(cavity.replaced, -1.0);
  if (gain > 1e-6 && cavity.quality > best.quality) best = std::move(cavity);
}

Vec3 CavityInsertion::middle_of(std::uint32_t c) const {
  Vec3 middle = Vec3::Zero();
  for (const std::uint32_t corner : complex_.cell(c).corners) middle += complex_.points[corner] / 4;
  return middle;
}

bool CavityInsertion::improve(std::uint32_t c, double goal, std::vector<std::uint32_t>& added) {
  Cavity best;
  attempt({c}, middle_of(c), goal, best);
  TetComplex::Ring ring;
  for (std::size_t edge = 0; edge < 6 && best.quality < goal; ++edge)
    if (complex_.ring(c, edge, 20, ring) && ring.closed)
      attempt(ring.cells, (complex_.points[ring.from] + complex_.points[ring.to]) / 2, goal, best);
  // A flat one on a wall leaves no room by itself, and no way over the wall: with what is beside it.
  std::vector<std::uint32_t> seed = {c};
  for (std::size_t slot = 0; slot < 4 && best.quality < goal; ++slot) {
    const std::uint32_t beside = complex_.cell(c).beside[slot];
    if (beside == TetComplex::none) continue;
    attempt({c, beside}, middle_of(beside), goal, best);
    seed.push_back(beside);
  }
  if (best.quality < goal && seed.size() > 2) {
    Vec3 centre = Vec3::Zero();
    for (const std::uint32_t cell : seed) centre += middle_of(cell) / static_cast<double>(seed.size());
    attempt(seed, centre, goal, best);
  }
  if (best.cells.empty()) return false;
  const std::uint32_t point = complex_.add_point(best.at);
  new_cells_.clear();
  for (const Side& side : best.sides)
    new_cells_.push_back({point, side.corners[0], side.corners[1], side.corners[2]});
  complex_.replace(best.cells, new_cells_, added);
  return true;
}

}  // namespace selvage::fem
