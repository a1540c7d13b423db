#include "tetrahedra/ring_exchange.h"

#include <algorithm>
#include <limits>

namespace selvage::fem {
namespace {

constexpr double unknown = 9;
constexpr double infinite = std::numeric_limits<double>::infinity();
// A gain below this is rounding.
constexpr double least_gain = 1e-9;

}  // namespace

// The two tetrahedra over a triangle of three points round the edge, the lesser quality.
double RingExchange::triangle_quality(std::size_t i, std::size_t j, std::size_t k) {
  const std::size_t count = ring_.around.size();
  std::array<std::size_t, 3> at = {i % count, j % count, k % count};
  // The same triangle may be asked for from each of its corners.
  std::rotate(at.begin(), std::min_element(at.begin(), at.end()), at.end());
  double& known = triangle_[at[0]][at[1]][at[2]];
  if (known == unknown) {
    const std::uint32_t a = corner(at[0]), b = corner(at[1]), c = corner(at[2]);
    known = complex_.quality({a, b, c, ring_.to});
    if (known > bound_) known = std::min(known, complex_.quality({a, c, b, ring_.from}));
  }
  return known;
}

double RingExchange::at_edge(std::size_t i, std::size_t j) {
  const std::size_t count = ring_.around.size();
  double& known = at_edge_[i % count][j % count];
  if (known == unknown) known = complex_.quality({ring_.from, ring_.to, corner(i), corner(j)});
  return known;
}

void RingExchange::cut_off_best() {
  const std::size_t count = ring_.around.size();
  for (std::size_t i = 0; i < count; ++i) fan_[i][1] = infinite;
  for (std::size_t length = 2; length < count; ++length)
    for (std::size_t i = 0; ring_.closed ? i < count : i + length < count; ++i) {
      double best = inverted_quality;
      for (std::size_t k = 1; k < length; ++k) {
        double value = std::min(fan_[i][k], fan_[(i + k) % count][length - k]);
        if (value <= std::max(best, bound_)) continue;
        value = std::min(value, triangle_quality(i, i + k, i + length));
        if (value <= best) continue;
        best = value;
        apex_[i][length] = static_cast<std::uint8_t>(k);
      }
      fan_[i][length] = best;
    }
}

// The best chain of tetrahedra that stay at the edge, from point `start` on: round to it again, or to the
// last.
double RingExchange::best_chain(std::size_t start) {
  const std::size_t steps = ring_.cells.size(), longest = std::min(steps, ring_.around.size() - 1);
  std::array<double, most + 2> best{};
  best[0] = infinite;
  for (std::size_t to = 1; to <= steps; ++to) {
    best[to] = inverted_quality;
    for (std::size_t length = 1; length <= std::min(to, longest); ++length) {
      const std::size_t from = (start + to - length) % ring_.around.size();
      double value = std::min(best[to - length], fan_[from][length]);
      if (value <= std::max(best[to], bound_)) continue;
      value = std::min(value, at_edge(from, from + length));
      if (value <= best[to]) continue;
      best[to] = value;
      previous_[to] = static_cast<std::uint8_t>(length);
    }
  }
  return best[steps];
}

void RingExchange::emit_fan(std::size_t i, std::size_t length) {
  if (length < 2) return;
  const std::size_t k = apex_[i % ring_.around.size()][length];
  new_cells_.push_back({corner(i), corner(i + k), corner(i + length), ring_.to});
  new_cells_.push_back({corner(i), corner(i + length), corner(i + k), ring_.from});
  emit_fan(i, k);
  emit_fan(i + k, length - k);
}

void RingExchange::emit_chain(std::size_t start) {
  for (std::size_t to = ring_.cells.size(); to > 0; to -= previous_[to]) {
    const std::size_t length = previous_[to], from = start + to - length;
    new_cells_.push_back({ring_.from, ring_.to, corner(from), corner(from + length)});
    emit_fan(from, length);
  }
}

bool RingExchange::improve(std::uint32_t cell, std::size_t edge, std::vector<std::uint32_t>& added) {
  if (!complex_.ring(cell, edge, most, ring_) || ring_.cells.size() < 2) return false;
  double now = infinite;
  for (const std::uint32_t c : ring_.cells) now = std::min(now, complex_.cell(c).quality);
  bound_ = std::max(now, -1.0) + least_gain;
  const std::size_t count = ring_.around.size();
  for (std::size_t i = 0; i < count; ++i) {
    at_edge_[i].fill(unknown);
    for (std::size_t j = i + 1; j < count; ++j) triangle_[i][j].fill(unknown);
  }
  cut_off_best();
  double best = bound_;
  bool without = false;
  std::size_t start = count;
  if (ring_.closed && count >= 3 && fan_[0][count - 1] > best) {
    best = fan_[0][count - 1];
    without = true;
  }
  for (std::size_t from = 0; from < (ring_.closed ? count : 1); ++from) {
    const double value = best_chain(from);
    if (value <= best) continue;
    best = value;
    start = from;
  }
  if (start < count) {
    // Its way is that of the last chain that was looked at, perhaps another one.
    best_chain(start);
    new_cells_.clear();
    emit_chain(start);
  } else if (without) {
    new_cells_.clear();
    emit_fan(0, count - 1);
  } else {
    return false;
  }
  complex_.replace(ring_.cells, new_cells_, added);
  return true;
}

}  // namespace selvage::fem
