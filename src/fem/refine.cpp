#include "fem/refine.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace selvage::fem {
namespace {

constexpr int most_steps = 200;  // of a walk to a centre
// A point sees a side of its cavity when it is over it by at least this square of a sine.
constexpr double least_square_sine = 1e-4;
// Of the shorter one of the radius and the shortest edge of what is split: how near to a corner a point may
// be.
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
  ball.is_bad = ball.square > options_.radius_edge * options_.radius_edge * shortest ||
                (options_.max_volume > 0 && six > 6 * options_.max_volume);
  ball.clearance = nearest * nearest * std::min(ball.square, shortest);
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

// Takes cells out whose outer sides the point does not see; false: it does not see the cell that it is in.
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
  return true;
}

// No corner of the cavity is nearer than `least`, and the place is in no ball over an edge of a wall.
bool Refiner::is_free(const Vec3& at, double least_square) const {
  for (const TetComplex::Side& s : sides_) {
    const TetComplex::Cell& cell = complex_.cell(s.cell);
    const auto& side = opposite_sides[s.slot];
    std::array<Vec3, 3> to;
    for (std::size_t k = 0; k < 3; ++k) {
      to[k] = complex_.points[cell.corners[side[k]]] - at;
      if (to[k].squaredNorm() < least_square) return false;
    }
    if (cell.beside[s.slot] != TetComplex::none) continue;
    for (std::size_t k = 0; k < 3; ++k)
      if (to[k].dot(to[(k + 1) % 3]) < 0) return false;
  }
  return true;
}

bool Refiner::split(std::uint32_t c) {
  const Vec3 at = balls_[c].centre;
  if (!at.allFinite()) return false;
  const std::uint32_t start = locate(c, at);
  if (start == TetComplex::none) return false;
  grow(start, at);
  if (!cut_back(start, at) || !is_free(at, balls_[c].clearance)) return false;
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
  complex_.measure_all();
  return points;
}

}  // namespace selvage::fem
