#include "tetrahedra/improve_account.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace selvage::fem {
namespace {

double dihedral(const Vec3& from, const Vec3& to, const Vec3& a, const Vec3& b) {
  const Vec3 along = (to - from).normalized();
  const Vec3 x = (a - from) - along * along.dot(a - from), y = (b - from) - along * along.dot(b - from);
  return std::atan2(x.cross(y).norm(), x.dot(y)) * 180 / std::numbers::pi;
}

// The smallest distance of two parallel planes with the tetrahedron between them.
double width(const std::array<Vec3, 4>& p) {
  const double six = std::abs((p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]));
  double largest = 0;  // over this comes the distance of a corner from its side, or of opposite edges
  for (const auto& side : opposite_sides)
    largest = std::max(largest, (p[side[1]] - p[side[0]]).cross(p[side[2]] - p[side[0]]).norm());
  for (std::size_t edge = 0; edge < 3; ++edge) {
    const auto& k = edge_corners[edge];
    largest = std::max(largest, (p[k[1]] - p[k[0]]).cross(p[k[3]] - p[k[2]]).norm());
  }
  return six / largest;
}

// Of each point the smallest angle of the surface's triangles at it whose angles are not all at least
// `target`, degrees; of others 180.
std::vector<float> needle_angles(const TetComplex& complex, double target) {
  std::vector<float> result(complex.points.size(), 180.0F);
  for (std::uint32_t c = 0; c < complex.cells().size(); ++c) {
    if (!complex.is_alive(c)) continue;
    const TetComplex::Cell& cell = complex.cell(c);
    for (std::size_t slot = 0; slot < 4; ++slot) {
      if (cell.beside[slot] != TetComplex::none) continue;
      double least = 180;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto corner = [&](std::size_t j) {
          return complex.points[cell.corners[opposite_sides[slot][j % 3]]];
        };
        const Vec3 a = corner(k + 1) - corner(k), b = corner(k + 2) - corner(k);
        least = std::min(least, std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi);
      }
      if (least >= target) continue;
      for (const std::size_t k : opposite_sides[slot]) {
        float& at = result[cell.corners[k]];
        at = std::min(at, static_cast<float>(least));
      }
    }
  }
  return result;
}

// Why a cell is still below the target.
BelowTarget account(const TetComplex& complex, std::uint32_t c, double target,
                    const std::vector<float>& needles) {
  BelowTarget result;
  const TetComplex::Cell& cell = complex.cell(c);
  std::array<Vec3, 4> p;
  bool all_fixed = true;
  for (std::size_t k = 0; k < 4; ++k) {
    p[k] = complex.points[cell.corners[k]];
    result.at += p[k] / 4;
    all_fixed = all_fixed && complex.is_fixed(cell.corners[k]);
  }
  result.angle = angle_of_quality(cell.quality);
  TetComplex::Ring ring;
  for (std::size_t edge = 0; edge < 6; ++edge) {
    if (!complex.ring(c, edge, 100, ring) || ring.closed) continue;
    const Vec3 &from = complex.points[ring.from], &to = complex.points[ring.to];
    double wedge = 0;
    for (std::size_t k = 0; k + 1 < ring.around.size(); ++k)
      wedge += dihedral(from, to, complex.points[ring.around[k]], complex.points[ring.around[k + 1]]);
    if (wedge >= target || (result.cause == BelowTarget::Cause::geometry && wedge >= result.wedge)) continue;
    result.cause = BelowTarget::Cause::geometry;
    result.wedge = wedge;
    result.at = (from + to) / 2;
  }
  if (result.cause == BelowTarget::Cause::geometry) return result;
  float needle = 180;
  for (const std::uint32_t corner : cell.corners) needle = std::min(needle, needles[corner]);
  if (needle < 180) {
    result.cause = BelowTarget::Cause::needle;
    result.wedge = needle;
  } else if (all_fixed) {
    result.cause = BelowTarget::Cause::surface;
    result.edge_needed = 3 * width(p);
  }
  return result;
}

std::size_t how_many(const Improvement& improvement, BelowTarget::Cause cause) {
  return static_cast<std::size_t>(
      std::count_if(improvement.below.begin(), improvement.below.end(),
                    [cause](const BelowTarget& below) { return below.cause == cause; }));
}

std::string text_of(const BelowTarget& worst, std::size_t count, double target, double least_edge,
                    std::string_view unit) {
  const std::string start =
      fmt::format("{} dihedral angle below {:.3g} degrees",
                  count == 1 ? "1 tetrahedron has a" : fmt::format("{} tetrahedra have a", count), target);
  switch (worst.cause) {
    case BelowTarget::Cause::geometry:
      return fmt::format(
          "{}: they stand in wedges of the geometry, where faces meet under less than that, and "
          "no mesh of them is better; the sharpest wedge has {:.3g} degrees",
          start, worst.wedge);
    case BelowTarget::Cause::needle:
      return fmt::format(
          "{}, the smallest {:.3g}: they stand at triangles of the surface that are needles "
          "themselves, the sharpest with {:.3g} degrees; another --size may help",
          start, worst.angle, worst.wedge);
    case BelowTarget::Cause::surface:
      return fmt::format(
          "{}, the smallest {:.3g}, in gaps that are thin for the triangles beside them; edges of "
          "{:.3g} {} would do in the narrowest: choose a finer --size",
          start, worst.angle, least_edge, unit);
    case BelowTarget::Cause::inner:
      break;
  }
  return fmt::format("{}, the smallest {:.3g}; another --size may help", start, worst.angle);
}

}  // namespace

std::vector<BelowTarget> below_target(const TetComplex& complex, double target) {
  const double goal = quality_of_angle(target);
  std::vector<BelowTarget> result;
  std::vector<float> needles;
  std::size_t number = 0;
  for (std::uint32_t c = 0; c < complex.cells().size(); ++c) {
    if (!complex.is_alive(c)) continue;
    if (complex.cell(c).quality < goal) {
      if (needles.empty()) needles = needle_angles(complex, target);
      result.push_back(account(complex, c, target, needles));
      result.back().cell = number;
    }
    ++number;
  }
  return result;
}

std::vector<Message> describe(const Improvement& improvement, double target, std::string_view unit) {
  using Cause = BelowTarget::Cause;
  std::vector<Message> result;
  for (const Cause cause : {Cause::geometry, Cause::needle, Cause::surface, Cause::inner}) {
    const BelowTarget* worst = nullptr;
    double least_edge = 0;
    for (const BelowTarget& below : improvement.below) {
      if (below.cause != cause) continue;
      const bool is_worse = worst == nullptr || (cause == Cause::geometry && below.wedge < worst->wedge);
      least_edge = worst == nullptr ? below.edge_needed : std::min(least_edge, below.edge_needed);
      if (is_worse) worst = &below;
    }
    if (worst == nullptr) continue;
    const std::string text = text_of(*worst, how_many(improvement, cause), target, least_edge, unit);
    result.push_back((cause == Cause::geometry ? note(Kind::geometry, text) : warning(Kind::geometry, text))
                         .at_point(worst->at));
  }
  return result;
}

AngleTarget count(const Improvement& improvement, double target) {
  return {.wanted = target,
          .below = improvement.below.size(),
          .in_wedges = how_many(improvement, BelowTarget::Cause::geometry)};
}

}  // namespace selvage::fem
