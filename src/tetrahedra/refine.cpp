#include "tetrahedra/refine.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace selvage::fem {
namespace {

constexpr int most_steps = 200;  // of a walk to a centre
// A point sees a side of its cavity when it is over it by at least this square of a sine.
constexpr double least_square_sine = 1e-4;
// How near to others a point in a cell that is only too large may be: of the shorter one of its radius and
// its shortest edge.
constexpr double nearest = 0.6;

}  // namespace

// Circumsphere, and whether the cell is too slender or too large.
void Refiner::measure(std::uint32_t c) {
  const Tetrahedron& t = complex_.cell(c).corners;
  const Vec3& a = complex_.points[t[0]];
  const Vec3 ab = complex_.points[t[1]] - a, ac = complex_.points[t[2]] - a, ad = complex_.points[t[3]] - a;
  const Vec3 across = ac.cross(ad);
  const double six = ab.dot(across), b2 = ab.squaredNorm(), c2 = ac.squaredNorm(), d2 = ad.squaredNorm();
  const Vec3 to = (b2 * across + c2 * ad.cross(ab) + d2 * ab.cross(ac)) / (2 * six);
  const double shortest =
      std::min({b2, c2, d2, (ac - ab).squaredNorm(), (ad - ab).squaredNorm(), (ad - ac).squaredNorm()});
  Ball& ball = balls_[c];
  ball.centre = a + to;
  ball.square = to.squaredNorm();
  ball.mark = 0;
  const bool is_slender = ball.square > options_.radius_edge * options_.radius_edge * shortest;
  ball.is_bad = is_slender || (options_.max_volume > 0 && six > 6 * options_.max_volume);
  ball.clearance = is_slender ? shortest : nearest * nearest * std::min(ball.square, shortest);
}

// The cell that holds a place; none: a wall is between, or the way is too long.
std::uint32_t Refiner::locate(std::uint32_t c, const Vec3& at) const {
  for (int step = 0; step < most_steps; ++step) {
    const TetComplex::Cell& cell = complex_.cell(c);
    bool inside = true;
    for (std::size_t slot = 0; slot < 4 && inside; ++slot) {
      const auto& side = opposite_sides[slot];
      const Vec3& p = complex_.points[cell.corners[side[0]]];
      const Vec3 u = complex_.points[cell.corners[side[1]]] - p,
                 v = complex_.points[cell.corners[side[2]]] - p;
      if (u.cross(v).dot(at - p) <= 0) continue;
      c = cell.beside[slot];
      if (c == TetComplex::none) return c;
      inside = false;
    }
    if (inside) return c;
  }
  return TetComplex::none;
}

// The cells round a place whose circumspheres hold it.
void Refiner::grow(std::uint32_t start, const Vec3& at) {
  ++walk_;
  cavity_ = {start};
  balls_[start].mark = 2 * walk_ + 1;
  for (std::size_t k = 0; k < cavity_.size(); ++k)
    for (const std::uint32_t next : complex_.cell(cavity_[k]).beside) {
      if (next == TetComplex::none) continue;
      Ball& ball = balls_[next];
      if (ball.mark >= 2 * walk_) continue;
      const bool holds = !((at - ball.centre).squaredNorm() >= ball.square);
      ball.mark = 2 * walk_ + (holds ? 1 : 0);
      if (holds) cavity_.push_back(next);
    }
}

bool Refiner::sees(const Vec3& at, std::uint32_t c, std::size_t slot) const {
  const Tetrahedron& t = complex_.cell(c).corners;
  const auto& side = opposite_sides[slot];
  const Vec3& p = complex_.points[t[side[0]]];
  const Vec3 normal = (complex_.points[t[side[1]]] - p).cross(complex_.points[t[side[2]]] - p), to = p - at;
  const double height = normal.dot(to);
  return height > 0 && height * height > least_square_sine * normal.squaredNorm() * to.squaredNorm();
}

// No point is inside the cavity, off its sides: it would be lost.
bool Refiner::keeps_points() {
  outer_.resize(complex_.points.size(), 0);
  for (const TetComplex::Side& side : sides_)
    for (const std::size_t k : opposite_sides[side.slot]) outer_[complex_.cell(side.cell).corners[k]] = walk_;
  return std::all_of(cavity_.begin(), cavity_.end(), [this](std::uint32_t c) {
    const Tetrahedron& t = complex_.cell(c).corners;
    return std::all_of(t.begin(), t.end(), [this](std::uint32_t corner) { return outer_[corner] == walk_; });
  });
}

// Takes cells out whose outer sides the point does not see; false: it does not see the cell that it
// is in, or a point would be lost.
bool Refiner::cut_back(std::uint32_t start, const Vec3& at) {
  for (bool again = true; again;) {
    again = false;
    sides_.clear();
    for (const std::uint32_t c : cavity_) {
      if (!is_inside(c)) continue;
      for (std::uint32_t slot = 0; slot < 4; ++slot) {
        const std::uint32_t beside = complex_.cell(c).beside[slot];
        if (beside != TetComplex::none && is_inside(beside)) continue;
        if (sees(at, c, slot)) {
          sides_.push_back({c, slot});
          continue;
        }
        if (c == start) return false;
        balls_[c].mark = 2 * walk_;
        again = true;
        break;
      }
    }
  }
  std::erase_if(cavity_, [this](std::uint32_t c) { return !is_inside(c); });
  return keeps_points();
}

// No corner of a side is nearer than asked for, and if it is a wall, the place is in no ball over its edges.
bool Refiner::is_clear(const Vec3& at, std::uint32_t c, std::size_t slot, double square) const {
  const TetComplex::Cell& cell = complex_.cell(c);
  std::array<Vec3, 3> to;
  for (std::size_t k = 0; k < 3; ++k) {
    to[k] = complex_.points[cell.corners[opposite_sides[slot][k]]] - at;
    if (to[k].squaredNorm() < square) return false;
  }
  if (cell.beside[slot] != TetComplex::none) return true;
  return to[0].dot(to[1]) >= 0 && to[1].dot(to[2]) >= 0 && to[2].dot(to[0]) >= 0;
}

bool Refiner::split(std::uint32_t c) {
  const Vec3 at = balls_[c].centre;
  const double clearance = balls_[c].clearance;
  if (!at.allFinite()) return false;
  const std::uint32_t start = locate(c, at);
  if (start == TetComplex::none) return false;
  // What it is in says most often already that there is no room.
  for (std::size_t slot = 0; slot < 4; ++slot)
    if (!is_clear(at, start, slot, clearance)) return false;
  grow(start, at);
  if (!cut_back(start, at)) return false;
  for (const TetComplex::Side& side : sides_)
    if (!is_clear(at, side.cell, side.slot, clearance)) return false;
  complex_.replace_by_star(cavity_, sides_, complex_.add_point(at), added_);
  balls_.resize(complex_.cells().size());
  for (const std::uint32_t cell : added_) {
    measure(cell);
    if (balls_[cell].is_bad) queue_.push_back(cell);
  }
  return true;
}

std::size_t Refiner::run() {
  const auto count = static_cast<std::uint32_t>(complex_.cells().size());
  balls_.resize(count);
  std::vector<std::uint32_t> bad;
  for (std::uint32_t c = 0; c < count; ++c) {
    if (!complex_.is_alive(c)) continue;
    measure(c);
    if (balls_[c].is_bad) bad.push_back(c);
  }
  std::size_t points = 0;
  // What comes of one is looked at before the next, while it is still near in memory.
  for (const std::uint32_t first : bad) {
    queue_ = {first};
    while (!queue_.empty()) {
      const std::uint32_t c = queue_.back();
      queue_.pop_back();
      if (!complex_.is_alive(c) || !balls_[c].is_bad) continue;
      balls_[c].is_bad = false;
      points += split(c) ? 1 : 0;
    }
  }
  return points;
}

}  // namespace selvage::fem
