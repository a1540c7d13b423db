#include "fabric/disc_packing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "fabric/clearance.h"
#include "nurbs/roots.h"

namespace selvage::fabric {

namespace {

using std::numbers::pi;
constexpr std::size_t most_pushed = 30;

// Centres of symmetry of the hexagonal lattice with distance 1: a disc, the middle of two, of three.
const std::array<Vec2, 3>& lattice_centres() {
  static const std::array<Vec2, 3> centres = {Vec2(0.0, 0.0), Vec2(0.5, 0.0),
                                              Vec2(0.5, std::sqrt(3.0) / 6.0)};
  return centres;
}

// The smallest distance of two centres. Sorted by x, so that far pairs are never looked at.
double least_distance(std::vector<Vec2> centres) {
  std::sort(centres.begin(), centres.end(),
            [](const Vec2& a, const Vec2& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < centres.size(); ++i)
    for (std::size_t j = i + 1; j < centres.size() && centres[j].x() - centres[i].x() < least; ++j)
      least = std::min(least, (centres[j] - centres[i]).norm());
  return least;
}

// Scales centres so that discs of half their least distance fill the unit circle.
DiscPacking fitted(std::vector<Vec2> centres) {
  if (centres.size() == 1) return {1.0, {Vec2::Zero()}};
  double reach = 0.0;
  for (const Vec2& c : centres) reach = std::max(reach, c.norm());
  const double half = 0.5 * least_distance(centres), scale = 1.0 / (reach + half);
  for (Vec2& c : centres) c *= scale;
  return {half * scale, std::move(centres)};
}

// The n points of the lattice nearest to a centre of symmetry.
std::vector<Vec2> lattice_piece(std::size_t n, const Vec2& centre) {
  const int reach = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(n)))) + 3;
  std::vector<Vec2> points;
  for (int row = -reach; row <= reach; ++row)
    for (int column = -2 * reach; column <= 2 * reach; ++column)
      points.push_back(Vec2(column + 0.5 * row, 0.5 * std::sqrt(3.0) * row) - centre);
  // Rounding must not decide between points of one distance.
  const auto key = [](const Vec2& p) { return std::llround(p.squaredNorm() * 1e6); };
  std::sort(points.begin(), points.end(), [&](const Vec2& a, const Vec2& b) {
    const long long ka = key(a), kb = key(b);
    return ka != kb ? ka < kb : std::atan2(a.y(), a.x()) < std::atan2(b.y(), b.x());
  });
  points.resize(n);
  return points;
}

// Pushes overlapping discs of distance `d` apart and into the circle. True when none overlap any more.
bool push_apart(std::vector<Vec2>& centres, double d) {
  constexpr int sweeps = 400;
  constexpr double enough = 1e-7;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    double worst = 0.0;
    for (std::size_t i = 0; i < centres.size(); ++i) {
      for (std::size_t j = i + 1; j < centres.size(); ++j) {
        const Vec2 apart = centres[j] - centres[i];
        const double square = apart.squaredNorm();
        if (square >= d * d || square == 0.0) continue;
        const double distance = std::sqrt(square);
        worst = std::max(worst, d - distance);
        const Vec2 push = apart * (0.5 * (d - distance) / distance);
        centres[i] -= push;
        centres[j] += push;
      }
      const double out = centres[i].norm() + 0.5 * d - 1.0;
      worst = std::max(worst, out);
      if (out > 0.0) centres[i] *= 1.0 - out / centres[i].norm();
    }
    if (worst < enough * d) return true;
  }
  return false;
}

// Grows the discs for as long as pushing makes room for them.
DiscPacking grown(const std::vector<Vec2>& start) {
  DiscPacking best = fitted(start);
  double growth = 0.02;
  while (growth > 1e-5) {
    std::vector<Vec2> trial = best.centres;
    const bool found = push_apart(trial, 2.0 * best.radius * (1.0 + growth));
    DiscPacking next = fitted(trial);
    if (next.radius > best.radius) best = std::move(next);
    if (!found) growth *= 0.5;
  }
  return best;
}

// Rings of discs about the origin, the outermost first; the innermost may be a single disc.
std::vector<Vec2> rings(const std::vector<std::size_t>& counts, double turn) {
  std::vector<Vec2> centres;
  const auto levels = static_cast<double>(counts.size());
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const double radius = counts[k] == 1 ? 0.0 : (levels - static_cast<double>(k)) / (levels + 0.5);
    for (std::size_t i = 0; i < counts[k]; ++i) {
      const double angle =
          2.0 * pi * static_cast<double>(i) / static_cast<double>(counts[k]) + turn * static_cast<double>(k);
      centres.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
  }
  return centres;
}

// Counts of rings that n discs may take: the outermost holds about as many as fit there, the next ones 5 to 7
// fewer each.
void add_rings(std::vector<std::vector<std::size_t>>& all, std::vector<std::size_t>& counts,
               std::size_t rest) {
  if (rest == 0) return all.push_back(counts);
  const std::size_t outer = counts.back();
  if (rest <= 5 && outer >= rest + 4) {
    counts.push_back(rest);
    all.push_back(counts);
    counts.pop_back();
    return;
  }
  for (std::size_t fewer = 5; fewer <= 7; ++fewer) {
    if (outer <= fewer || outer - fewer > rest) continue;
    counts.push_back(outer - fewer);
    add_rings(all, counts, rest - (outer - fewer));
    counts.pop_back();
  }
}

std::vector<std::vector<Vec2>> starts_of(std::size_t n) {
  std::vector<std::vector<Vec2>> starts;
  for (const Vec2& centre : lattice_centres()) starts.push_back(fitted(lattice_piece(n, centre)).centres);
  std::vector<std::vector<std::size_t>> all;
  for (std::size_t outer = n; outer >= 2; --outer) {
    const double room = static_cast<double>(n) / static_cast<double>(outer * outer);
    if (n > 5 && (room < 0.06 || room > 0.25)) continue;  // too many outside, or too few
    std::vector<std::size_t> counts = {outer};
    add_rings(all, counts, n - outer);
  }
  for (const std::vector<std::size_t>& counts : all)
    for (const double turn : {0.0, 0.15, 0.4}) starts.push_back(rings(counts, turn));
  return starts;
}

}  // namespace

DiscPacking discs_in_circle(std::size_t n) {
  DiscPacking best{0.0, {}};
  if (n > most_pushed) {
    for (const Vec2& centre : lattice_centres()) {
      DiscPacking next = fitted(lattice_piece(n, centre));
      if (next.radius > best.radius) best = std::move(next);
    }
    return best;
  }
  if (n == 1) return fitted({Vec2::Zero()});
  for (const std::vector<Vec2>& start : starts_of(n)) {
    DiscPacking next = grown(start);
    if (next.radius > best.radius * (1.0 + 1e-6)) best = std::move(next);
  }
  return best;
}

DiscPacking discs_in_polygon(std::size_t n, const std::vector<Vec2>& polygon) {
  Eigen::AlignedBox2d box;
  for (const Vec2& p : polygon) box.extend(p);
  // The lattice's points with room for a disc of diameter d, both ways round and about each centre.
  const auto found = [&](double d) {
    std::vector<Vec2> best;
    for (const bool upright : {false, true})
      for (const Vec2& centre : lattice_centres()) {
        std::vector<Vec2> inside;
        const double dx = upright ? 0.5 * std::sqrt(3.0) * d : d, dy = upright ? d : 0.5 * std::sqrt(3.0) * d;
        const Vec2 origin = d * (upright ? Vec2(centre.y(), centre.x()) : centre);
        const int columns = static_cast<int>(box.sizes().x() / dx) + 3,
                  rows = static_cast<int>(box.sizes().y() / dy) + 3;
        for (int j = -rows; j <= rows; ++j)
          for (int i = -columns; i <= columns; ++i) {
            const Vec2 p = Vec2((i + (!upright && j % 2 != 0 ? 0.5 : 0.0)) * dx,
                                (j + (upright && i % 2 != 0 ? 0.5 : 0.0)) * dy) -
                           origin;
            if (signed_distance(polygon, p) <= -0.5 * d * (1.0 - 1e-9)) inside.push_back(p);
          }
        if (inside.size() > best.size()) best = std::move(inside);
      }
    return best;
  };
  const double area = box.sizes().x() * box.sizes().y();
  double fits = 0.5 * std::sqrt(area / static_cast<double>(n));
  for (int i = 0; i < 20 && found(fits).size() < n; ++i) fits *= 0.7;
  double low = fits, high = std::max(std::min(box.sizes().x(), box.sizes().y()), fits);
  nurbs::halve_between(low, high, 40, [&](double middle) { return found(middle).size() >= n; });
  DiscPacking packing{0.5 * low, found(low)};
  if (packing.centres.size() < n) return {0.0, {}};
  // Those too many go from the outside.
  std::stable_sort(packing.centres.begin(), packing.centres.end(), [](const Vec2& a, const Vec2& b) {
    return std::llround(a.squaredNorm() * 1e9) < std::llround(b.squaredNorm() * 1e9);
  });
  packing.centres.resize(n);
  return packing;
}

}  // namespace selvage::fabric
