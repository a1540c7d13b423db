#include "tetrahedra/improve.h"

#include <algorithm>
#include <numeric>

#include "core/parallel.h"
#include "tetrahedra/cavity.h"
#include "tetrahedra/improve_account.h"
#include "tetrahedra/point_place.h"
#include "tetrahedra/ring_exchange.h"
#include "tetrahedra/tet_complex.h"

namespace selvage::fem {
namespace {

class Improver {
 public:
  Improver(TetComplex& complex, double goal)
      : complex_(complex), goal_(goal), rings_(complex), insertion_(complex) {}

  // Over all cells below the goal, worst first. Returns how often something was gained.
  std::size_t pass(bool with_points);
  // Once over the same: only exchanges, and then each point at them is moved once. It costs little beside
  // pass(), which goes on as long as anything is gained.
  void polish();

 private:
  void gather();
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

// Pulls an inner point to one of its neighbours, the best of them, where its star becomes better by that.
bool Improver::contract_point(std::uint32_t point) {
  take_star(point);
  double best = 1;
  for (const std::uint32_t c : cells_) best = std::min(best, complex_.cell(c).quality);
  best += 1e-9;
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

// The cells below the goal, worst first.
void Improver::gather() {
  queue_.clear();
  for (std::uint32_t c = 0; c < complex_.cells().size(); ++c)
    if (is_bad(c)) queue_.push_back(c);
  std::sort(queue_.begin(), queue_.end(), [this](std::uint32_t a, std::uint32_t b) {
    const double qa = complex_.cell(a).quality, qb = complex_.cell(b).quality;
    return qa != qb ? qa < qb : a < b;
  });
}

void Improver::polish() {
  gather();
  const std::size_t most = 4 * queue_.size();
  for (std::size_t k = 0; k < queue_.size() && k < most; ++k)
    if (is_bad(queue_[k])) exchange(queue_[k]);
  gather();
  std::vector<bool> tried(complex_.points.size(), false);
  for (const std::uint32_t cell : queue_) {
    const Tetrahedron corners = complex_.cell(cell).corners;
    for (const std::uint32_t point : corners) {
      if (complex_.is_fixed(point) || tried[point] || !is_bad(cell)) continue;
      tried[point] = true;
      smooth_point(point);
    }
  }
}

std::size_t Improver::pass(bool with_points) {
  gather();
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

// One region: its points in their order among all, those that stay first, and its cells.
struct Part {
  std::uint32_t region = 0;
  std::vector<std::uint32_t> numbers;  // of its points among all
  std::size_t fixed_points = 0;
  std::vector<Vec3> points;
  std::vector<Tetrahedron> cells;
  std::vector<BelowTarget> below;
  bool was_below = false;          // any of its cells was below the target
  std::vector<std::uint8_t> used;  // of each point: a cell has it
};

std::vector<Part> divide(const std::vector<Vec3>& points, const std::vector<Tetrahedron>& cells,
                         const std::vector<std::uint32_t>& regions, std::size_t fixed_points) {
  std::vector<std::uint32_t> order(regions);
  std::sort(order.begin(), order.end());
  order.erase(std::unique(order.begin(), order.end()), order.end());
  std::vector<Part> parts(order.size());
  for (std::size_t k = 0; k < parts.size(); ++k) parts[k].region = order[k];
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto at = std::lower_bound(order.begin(), order.end(), regions[c]) - order.begin();
    parts[static_cast<std::size_t>(at)].cells.push_back(cells[c]);
  }
  std::vector<std::uint32_t> own(points.size(), TetComplex::none);
  for (Part& part : parts) {
    for (const Tetrahedron& cell : part.cells)
      for (const std::uint32_t corner : cell) own[corner] = 0;
    for (std::uint32_t p = 0; p < points.size(); ++p) {
      if (own[p] == TetComplex::none) continue;
      own[p] = static_cast<std::uint32_t>(part.points.size());
      part.fixed_points += p < fixed_points ? 1 : 0;
      part.numbers.push_back(p);
      part.points.push_back(points[p]);
    }
    for (Tetrahedron& cell : part.cells)
      for (std::uint32_t& corner : cell) corner = own[corner];
    for (const std::uint32_t p : part.numbers) own[p] = TetComplex::none;
  }
  return parts;
}

void improve(Part& part, const ImproveOptions& options) {
  TetComplex complex(std::move(part.points), part.cells, part.fixed_points);
  if (options.refine) Refiner(complex, *options.refine).run();
  complex.measure_all();
  if (options.polish > 0)
    Improver(complex, quality_of_angle(std::max(options.target, options.polish))).polish();
  const double wanted = quality_of_angle(options.target);
  for (const TetComplex::Cell& cell : complex.cells()) {
    if (cell.corners[0] == TetComplex::none) continue;
    part.was_below = part.was_below || cell.quality < wanted;
  }
  // A little more is asked for, so that no other way of computing the angle finds it missed.
  Improver improver(complex, quality_of_angle(options.target + 1e-6));
  for (int pass = 0; pass < options.passes; ++pass)
    if (improver.pass(pass > 0) == 0 && pass > 0) break;
  part.below = below_target(complex, options.target);
  part.cells.clear();
  part.used.assign(complex.points.size(), 0);
  for (const TetComplex::Cell& cell : complex.cells()) {
    if (cell.corners[0] == TetComplex::none) continue;
    part.cells.push_back(cell.corners);
    for (const std::uint32_t corner : cell.corners) part.used[corner] = 1;
  }
  part.points = std::move(complex.points);
}

// The largest first, so that the others fill the time beside it.
void improve_all(std::vector<Part>& parts, const ImproveOptions& options) {
  std::vector<std::size_t> order(parts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return parts[a].cells.size() > parts[b].cells.size();
  });
  for_each_index(order.size(), options.threads, [&](std::size_t k) { improve(parts[order[k]], options); });
}

// Puts the parts into the caller's arrays: first the points that were there, then the new ones of each part.
void join(std::vector<Part>& parts, std::vector<Vec3>& points, std::vector<Tetrahedron>& cells,
          std::vector<std::uint32_t>& regions, std::size_t fixed_points, Improvement& result) {
  const std::size_t before = points.size();
  std::vector<std::uint8_t> used(before, 0);
  for (const Part& part : parts)
    for (std::size_t p = 0; p < part.numbers.size(); ++p) {
      if (part.used[p] == 0) continue;
      used[part.numbers[p]] = 1;
      points[part.numbers[p]] = part.points[p];
    }
  std::vector<std::uint32_t> number(before, TetComplex::none);
  std::size_t count = 0;
  for (std::size_t p = 0; p < before; ++p) {
    if (p >= fixed_points && used[p] == 0) continue;
    points[count] = points[p];
    number[p] = static_cast<std::uint32_t>(count++);
  }
  points.resize(count);
  cells.clear();
  regions.clear();
  for (Part& part : parts) {
    for (std::uint32_t& p : part.numbers) p = number[p];
    for (std::size_t p = part.numbers.size(); p < part.points.size(); ++p) {
      part.numbers.push_back(static_cast<std::uint32_t>(points.size()));
      if (part.used[p] != 0) points.push_back(part.points[p]);
    }
    for (BelowTarget& below : part.below) {
      below.cell += cells.size();
      result.below.push_back(below);
    }
    for (Tetrahedron cell : part.cells) {
      for (std::uint32_t& corner : cell) corner = part.numbers[corner];
      cells.push_back(cell);
    }
    regions.resize(cells.size(), part.region);
    part = {};
  }
}

}  // namespace

Improvement improve(std::vector<Vec3>& points, std::vector<Tetrahedron>& cells,
                    std::vector<std::uint32_t>& regions, std::size_t fixed_points,
                    const ImproveOptions& options) {
  Improvement result;
  std::vector<Part> parts = divide(points, cells, regions, fixed_points);
  improve_all(parts, options);
  const bool was_below = std::ranges::any_of(parts, &Part::was_below);
  if (!was_below && !options.refine && !(options.polish > 0)) return result;
  join(parts, points, cells, regions, std::min(fixed_points, points.size()), result);
  std::stable_sort(result.below.begin(), result.below.end(),
                   [](const BelowTarget& a, const BelowTarget& b) { return a.angle < b.angle; });
  return result;
}

}  // namespace selvage::fem
