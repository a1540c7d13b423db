#include "contact/ties.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/bounds.h"
#include "nurbs/spline.h"

namespace selvage::contact {

namespace {

constexpr int probes = 13;

// A strand's centre line as a polygon over its arc length.
struct Line {
  std::vector<Vec3> points;
  Box3 box;
  double step = 0, length = 0;

  explicit Line(const Strand& strand) : length(strand.length()) {
    const int count = std::max(32, 8 * strand.nodes());
    step = length / count;
    for (int i = 0; i <= count; ++i) points.push_back(strand.centre_at(i * step));
    for (const Vec3& p : points) box.extend(p);
  }
  [[nodiscard]] Vec3 at(double arc) const {
    const double place = std::clamp(arc / step, 0.0, static_cast<double>(points.size() - 1));
    const auto k = std::min(static_cast<std::size_t>(place), points.size() - 2);
    const double share = place - static_cast<double>(k);
    return (1.0 - share) * points[k] + share * points[k + 1];
  }
  // The arc length of the nearest point when that is nearer than `reach`.
  [[nodiscard]] std::optional<double> find(const Vec3& p, double reach) const {
    if (box.squaredExteriorDistance(p) > reach * reach) return std::nullopt;
    double best = reach, arc = -1.0;
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      const double share = nearest_share(p, points[k], points[k + 1]);
      const double distance = (points[k] + share * (points[k + 1] - points[k]) - p).norm();
      if (distance < best) {
        best = distance;
        arc = (static_cast<double>(k) + share) * step;
      }
    }
    return arc < 0.0 ? std::nullopt : std::optional(arc);
  }
};

// The shift s with to(arc + s) = from(arc) + period, when there is one.
std::optional<double> find_shift(const Line& from, const Line& to, const Vec3& period, double reach) {
  for (int i = 0; i < probes; ++i) {
    const double arc = from.length * (i + 0.5) / probes;
    const std::optional<double> found = to.find(from.at(arc) + period, reach);
    if (!found) continue;
    const double shift = *found - arc;
    int common = 0;
    bool fits = true;
    for (int j = 0; j < 4 * probes && fits; ++j) {
      const double other = from.length * (j + 0.5) / (4 * probes);
      if (other + shift < 0.0 || other + shift > to.length) continue;
      ++common;
      fits = (to.at(other + shift) - from.at(other) - period).norm() <= 2.0 * reach;
    }
    if (fits && common >= 2) return shift;
  }
  return std::nullopt;
}

struct Tie {
  std::size_t from = 0, to = 0;
  double shift = 0;
};

}  // namespace

std::vector<std::size_t> tie_strands(std::span<Strand> strands, std::span<const Vec3> periods) {
  const std::size_t n = strands.size();
  std::vector<std::vector<Tie>> ties(n);
  if (!periods.empty()) {
    std::vector<Line> lines;
    for (const Strand& strand : strands) lines.emplace_back(strand);
    for (const Vec3& period : periods)
      for (std::size_t y = 0; y < n; ++y)
        for (std::size_t z = 0; z < n; ++z) {
          if (strands[y].is_cyclic() || strands[z].is_cyclic()) continue;
          const double reach = 0.01 * std::min(strands[y].thickness(), strands[z].thickness());
          if (const std::optional<double> shift = find_shift(lines[y], lines[z], period, reach)) {
            ties[y].push_back({y, z, *shift});
            ties[z].push_back({z, y, -*shift});
          }
        }
  }
  std::vector<std::size_t> lattice(n, n);
  std::vector<double> origin(n, 0.0);
  std::size_t count = 0;
  for (std::size_t first = 0; first < n; ++first) {
    if (lattice[first] != n) continue;
    std::vector<std::size_t> members = {first};
    lattice[first] = count;
    double cycle = infinity;
    for (std::size_t k = 0; k < members.size(); ++k)
      for (const Tie& t : ties[members[k]]) {
        const double place = origin[t.from] - t.shift;
        if (lattice[t.to] == n) {
          lattice[t.to] = count;
          origin[t.to] = place;
          members.push_back(t.to);
        } else if (const double apart = std::abs(origin[t.to] - place); apart > strands[t.to].thickness()) {
          cycle = std::min(cycle, apart);
        }
      }
    ++count;
    if (members.size() == 1 && !std::isfinite(cycle)) continue;
    double low = infinity;
    for (std::size_t y : members) low = std::min(low, origin[y]);
    double spacing = strands[first].spacing();
    int nodes = 0;
    if (std::isfinite(cycle)) {
      nodes = std::max(4, static_cast<int>(std::lround(cycle / spacing)));
      spacing = cycle / nodes;
    } else {
      for (std::size_t y : members)
        nodes = std::max(nodes,
                         static_cast<int>(std::ceil((origin[y] - low + strands[y].length()) / spacing)) + 3);
    }
    for (std::size_t y : members)
      strands[y].set_lattice(spacing, origin[y] - low, nodes, std::isfinite(cycle));
  }
  return lattice;
}

}  // namespace selvage::contact
