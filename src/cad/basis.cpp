#include "cad/basis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cad/model.h"

namespace selvage::cad {

namespace {

using nurbs::Surface;

constexpr double largest_knot_gap = 1e-6;  // of the domain

struct Direction {
  const std::vector<double>& knots;
  int degree, count;
};

Direction along(const Surface& s, bool v) {
  return v ? Direction{s.knots_v, s.degree_v, s.count_v} : Direction{s.knots_u, s.degree_u, s.count_u};
}

// The largest distance of two knots that belong together, as a share of the domain; infinite where degrees or
// counts differ.
double knot_gap(const Direction& a, const Direction& b, bool backward) {
  constexpr double apart = std::numeric_limits<double>::infinity();
  if (a.degree != b.degree || a.count != b.count || a.knots.size() != b.knots.size()) return apart;
  if (!backward && a.knots == b.knots) return 0;
  const auto first = static_cast<std::size_t>(a.degree), last = static_cast<std::size_t>(a.count);
  const double start_a = a.knots[first], length_a = a.knots[last] - start_a;
  const double start_b = b.knots[first], length_b = b.knots[last] - start_b;
  double gap = 0;
  for (std::size_t k = 0; k < a.knots.size(); ++k) {
    const double share = (b.knots[backward ? b.knots.size() - 1 - k : k] - start_b) / length_b;
    gap = std::max(gap, std::abs((a.knots[k] - start_a) / length_a - (backward ? 1 - share : share)));
  }
  return gap <= 4 * std::numeric_limits<double>::epsilon() ? 0 : gap;
}

// The largest coefficient of the first derivative, over a domain of length 1.
double largest_slope(const Surface& s, bool v) {
  const Direction d = along(s, v);
  const double length =
      d.knots[static_cast<std::size_t>(d.count)] - d.knots[static_cast<std::size_t>(d.degree)];
  double slope = 0;
  for (int j = v ? 1 : 0; j < s.count_v; ++j)
    for (int i = v ? 0 : 1; i < s.count_u; ++i) {
      const auto k = static_cast<std::size_t>(v ? j : i);
      const double span = (d.knots[k + static_cast<std::size_t>(d.degree)] - d.knots[k]) / length;
      const Vec3 step = s.point(i, j) - (v ? s.point(i, j - 1) : s.point(i - 1, j));
      if (span > 0) slope = std::max(slope, d.degree * step.norm() / span);
    }
  return slope;
}

// Weighted means of the same points whose weights differ by a factor between low and high are at most
// (high / low - 1) times the points' extent apart.
double weight_slack(const Surface& a, const Surface& b, const Alignment& alignment) {
  if (!a.is_rational() && !b.is_rational()) return 0;
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (int j = 0; j < a.count_v; ++j)
    for (int i = 0; i < a.count_u; ++i) {
      const std::size_t k = alignment.index_in(b, i, j);
      const double factor = (b.weights.empty() ? 1.0 : b.weights[k]) / a.weight(i, j);
      low = std::min(low, factor);
      high = std::max(high, factor);
    }
  return (high / low - 1) * box_of(a.points).diagonal().norm();
}

// One of the eight ways.
struct Lay {
  Alignment alignment;
  double gap_u = 0, gap_v = 0;
  [[nodiscard]] bool fits() const { return std::max(gap_u, gap_v) <= largest_knot_gap; }
};

Lay lay_along(const Surface& a, const Surface& b, int way) {
  Lay lay;
  lay.alignment = {(way & 4) != 0, (way & 1) != 0, (way & 2) != 0};
  const bool swapped = lay.alignment.swapped;
  lay.gap_u = knot_gap(along(a, false), along(b, swapped), lay.alignment.backward_u);
  if (lay.fits()) lay.gap_v = knot_gap(along(a, true), along(b, !swapped), lay.alignment.backward_v);
  return lay;
}

ControlChange change_of(const Surface& a, const Surface& b, const Lay& lay, double tolerance) {
  const auto& [alignment, gap_u, gap_v] = lay;
  ControlChange change;
  change.alignment = alignment;
  double squared = 0;
  for (int j = 0; j < a.count_v; ++j)
    for (int i = 0; i < a.count_u; ++i) {
      const double d = (b.points[alignment.index_in(b, i, j)] - a.point(i, j)).squaredNorm();
      if (d > tolerance * tolerance) ++change.changed;
      if (d <= squared) continue;
      squared = d;
      change.i = i;
      change.j = j;
    }
  change.largest = std::sqrt(squared);
  change.bound = change.largest + weight_slack(a, b, alignment);
  if (gap_u > 0) change.bound += 2 * gap_u * largest_slope(a, false);
  if (gap_v > 0) change.bound += 2 * gap_v * largest_slope(a, true);
  return change;
}

}  // namespace

std::size_t Alignment::index_in(const Surface& b, int i, int j) const {
  const int count_i = swapped ? b.count_v : b.count_u, count_j = swapped ? b.count_u : b.count_v;
  if (backward_u) i = count_i - 1 - i;
  if (backward_v) j = count_j - 1 - j;
  return swapped ? b.index(j, i) : b.index(i, j);
}

std::optional<ControlChange> compare_control_points(const Surface& a, const Surface& b, double tolerance) {
  std::optional<ControlChange> best;
  bool fits_as_it_is = false;
  for (int way = 0; way < 8; ++way) {
    const Lay lay = lay_along(a, b, way);
    if (!lay.fits()) continue;
    fits_as_it_is = fits_as_it_is || way == 0;
    const ControlChange change = change_of(a, b, lay, tolerance);
    if (!best || change.bound < best->bound) best = change;
    if (best->bound <= tolerance) break;
  }
  if (best) best->fits_as_it_is = fits_as_it_is;
  return best;
}

bool have_one_basis(const Surface& a, const Surface& b) {
  for (int way = 0; way < 8; ++way)
    if (lay_along(a, b, way).fits()) return true;
  return false;
}

}  // namespace selvage::cad
