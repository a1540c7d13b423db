#include "fem/improve.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fem/cavity.h"
#include "fem/point_place.h"
#include "fem/ring_exchange.h"
#include "fem/tet_complex.h"

namespace selvage::fem {
namespace {

class Improver {
 public:
  Improver(TetComplex& complex, double goal)
      : complex_(complex), goal_(goal), rings_(complex), insertion_(complex) {}

  // Over all cells below the goal, worst first. Returns how often something was gained.
  std::size_t pass(bool with_points);

 private:
  bool exchange(std::uint32_t cell);
  bool smooth(std::uint32_t cell);
  bool smooth_point(std::uint32_t point);
  bool contract(std::uint32_t cell);
  bool contract_point(std::uint32_t point);
  bool insert(std::uint32_t cell);
  [[nodiscard]] bool is_bad(std::uint32_t cell) const {
    return complex_.is_alive(cell) && complex_.cell(cell).quality < goal_;
  }
  void take_star(std::uint32_t point);

  TetComplex& complex_;
  double goal_;
  RingExchange rings_;
  CavityInsertion insertion_;
  PointPlace point_place_;
  std::vector<std::uint32_t> queue_, added_, cells_;
  std::vector<TetFace> outer_;  // the sides of a star, opposite its point
  std::vector<StarSide> sides_;
  std::vector<Tetrahedron> new_cells_, best_cells_;
};

bool Improver::exchange(std::uint32_t cell) {
  for (std::size_t edge = 0; edge < 6; ++edge)
    if (rings_.improve(cell, edge, added_)) {
      queue_.insert(queue_.end(), added_.begin(), added_.end());
      return true;
    }
  return false;
}

void Improver::take_star(std::uint32_t point) {
  complex_.star(point, cells_);
  outer_.clear();
  sides_.clear();
  for (const std::uint32_t c : cells_) {
    const Tetrahedron& t = complex_.cell(c).corners;
    const auto slot = static_cast<std::size_t>(std::find(t.begin(), t.end(), point) - t.begin());
    const auto& side = opposite_sides[slot];
    outer_.push_back({t[side[0]], t[side[1]], t[side[2]]});
    sides_.push_back({complex_.points[t[side[0]]], complex_.points[t[side[1]]], complex_.points[t[side[2]]]});
  }
}

bool Improver::smooth_point(std::uint32_t point) {
  take_star(point);
  double before = 1;
  for (const std::uint32_t c : cells_) before = std::min(before, complex_.cell(c).quality);
  Vec3 at = complex_.points[point];
  if (point_place_.improve(at, sides_, goal_) <= before) return false;
  complex_.points[point] = at;
  complex_.measure_star(point);
  return true;
}

bool Improver::smooth(std::uint32_t cell) {
  bool gained = false;
  for (const std::uint32_t point : complex_.cell(cell).corners)
    if (!complex_.is_fixed(point) && smooth_point(point)) {
      gained = true;
      if (!is_bad(cell)) break;
    }
  return gained;
}

// Pulls an inner point to one of its neighbours, the best of them.
bool Improver::contract_point(std::uint32_t point) {
  take_star(point);
  double best = -1;
  for (const std::uint32_t c : cells_) best = std::min(best, complex_.cell(c).quality);
  best = std::max(best, -1.0) + 1e-9;
  std::vector<std::uint32_t> around;
  for (const TetFace& side : outer_) around.insert(around.end(), side.begin(), side.end());
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  bool found = false;
  for (const std::uint32_t to : around) {
    double least = 1;
    new_cells_.clear();
    for (const TetFace& side : outer_) {
      if (std::find(side.begin(), side.end(), to) != side.end()) continue;
      new_cells_.push_back({to, side[0], side[1], side[2]});
      least = std::min(least, complex_.quality(new_cells_.back()));
      if (least <= best) break;
    }
    if (least <= best) continue;
    best = least;
    best_cells_ = new_cells_;
    found = true;
  }
  if (!found) return false;
  complex_.replace(cells_, best_cells_, added_);
  queue_.insert(queue_.end(), added_.begin(), added_.end());
  return true;
}

bool Improver::contract(std::uint32_t cell) {
  const Tetrahedron corners = complex_.cell(cell).corners;
  return std::any_of(corners.begin(), corners.end(), [this](std::uint32_t point) {
    return !complex_.is_fixed(point) && contract_point(point);
  });
}

bool Improver::insert(std::uint32_t cell) {
  if (!insertion_.improve(cell, goal_, added_)) return false;
  queue_.insert(queue_.end(), added_.begin(), added_.end());
  return true;
}

std::size_t Improver::pass(bool with_points) {
  queue_.clear();
  for (std::uint32_t c = 0; c < complex_.cells().size(); ++c)
    if (is_bad(c)) queue_.push_back(c);
  std::sort(queue_.begin(), queue_.end(), [this](std::uint32_t a, std::uint32_t b) {
    const double qa = complex_.cell(a).quality, qb = complex_.cell(b).quality;
    return qa != qb ? qa < qb : a < b;
  });
  // What an exchange leaves is looked at too, but not without end.
  const std::size_t most = 4 * queue_.size();
  std::size_t gains = 0;
  for (std::size_t k = 0; k < queue_.size() && k < most; ++k) {
    const std::uint32_t cell = queue_[k];
    if (!is_bad(cell)) continue;
    const bool gained = exchange(cell) || smooth(cell) || (with_points && (contract(cell) || insert(cell)));
    gains += gained ? 1 : 0;
    if (gained && is_bad(cell)) queue_.push_back(cell);
  }
  return gains;
}

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

// Puts what is left into the caller's arrays, and says what is below the target.
class Writer {
 public:
  Writer(const TetComplex& complex, double target, Improvement& result)
      : complex_(complex), target_(target), result_(result) {}

  void write(std::size_t fixed_points, std::vector<Vec3>& points) {
    number_.assign(complex_.points.size(), TetComplex::none);
    std::vector<std::uint8_t> used(complex_.points.size(), 0);
    for (const TetComplex::Cell& cell : complex_.cells())
      if (cell.corners[0] != TetComplex::none)
        for (const std::uint32_t corner : cell.corners) used[corner] = 1;
    const std::size_t before = points.size();
    points.resize(fixed_points);
    for (std::uint32_t p = 0; p < complex_.points.size(); ++p) {
      number_[p] = p < fixed_points ? p : static_cast<std::uint32_t>(points.size());
      if (p < fixed_points) continue;
      if (used[p] != 0) points.push_back(complex_.points[p]);
      result_.points_removed += p < before && used[p] == 0 ? 1 : 0;
      result_.points_added += p >= before && used[p] != 0 ? 1 : 0;
    }
  }

  void write(std::vector<Tetrahedron>& cells, std::vector<std::uint32_t>& regions) {
    cells.clear();
    regions.clear();
    const double goal = quality_of_angle(target_);
    const std::vector<float> needles = needle_angles(complex_, target_);
    double least = 1;
    for (std::uint32_t c = 0; c < complex_.cells().size(); ++c) {
      if (!complex_.is_alive(c)) continue;
      const TetComplex::Cell& cell = complex_.cell(c);
      least = std::min(least, cell.quality);
      if (cell.quality < goal) {
        result_.below.push_back(account(complex_, c, target_, needles));
        result_.below.back().cell = cells.size();
      }
      Tetrahedron t = cell.corners;
      for (std::uint32_t& corner : t) corner = number_[corner];
      cells.push_back(t);
      regions.push_back(cell.region);
    }
    std::stable_sort(result_.below.begin(), result_.below.end(),
                     [](const BelowTarget& a, const BelowTarget& b) { return a.angle < b.angle; });
    result_.angle_after = angle_of_quality(least);
  }

 private:
  const TetComplex& complex_;
  double target_;
  Improvement& result_;
  std::vector<std::uint32_t> number_;
};

}  // namespace

Improvement improve(std::vector<Vec3>& points, std::vector<Tetrahedron>& cells,
                    std::vector<std::uint32_t>& regions, std::size_t fixed_points,
                    const ImproveOptions& options) {
  Improvement result;
  fixed_points = std::min(fixed_points, points.size());
  TetComplex complex(points, cells, regions, fixed_points);
  const double wanted = quality_of_angle(options.target);
  double least = 1;
  for (const TetComplex::Cell& cell : complex.cells()) {
    least = std::min(least, cell.quality);
    result.below_before += cell.quality < wanted ? 1 : 0;
  }
  result.angle_before = angle_of_quality(least);
  // A little more is asked for, so that no other way of computing the angle finds it missed.
  Improver improver(complex, quality_of_angle(options.target + 1e-6));
  for (int pass = 0; pass < options.passes; ++pass)
    if (improver.pass(pass > 0) == 0 && pass > 0) break;
  Writer writer(complex, options.target, result);
  writer.write(fixed_points, points);
  writer.write(cells, regions);
  return result;
}

}  // namespace selvage::fem
