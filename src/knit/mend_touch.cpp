#include "knit/mend_touch.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>

namespace selvage::fabric {

namespace {

constexpr double cell_length = 0.6;  // in radii

double reach_of(const MendLine& line, const Vec3& tangent, const Vec3& direction) {
  return line.reach ? line.reach(tangent, direction) : line.radius;
}

// Points in cubes of a given size, by cube.
class Cubes {
 public:
  Cubes(const std::vector<CellPoint>& points, double size) : size_(size) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed;
    keyed.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      keyed.emplace_back(key(index(points[i].position)), static_cast<std::uint32_t>(i));
    std::sort(keyed.begin(), keyed.end());
    members_.reserve(keyed.size());
    for (std::size_t i = 0; i < keyed.size(); ++i) {
      members_.push_back(keyed[i].second);
      auto [cube, is_new] = cubes_.try_emplace(keyed[i].first, i, i + 1);
      if (!is_new) cube->second.second = i + 1;
    }
  }

  // The points of the cubes round this one's, by increasing number.
  void near(const Vec3& position, std::vector<std::uint32_t>& found) const {
    found.clear();
    const std::array<std::int64_t, 3> middle = index(position);
    for (std::int64_t x = -1; x <= 1; ++x)
      for (std::int64_t y = -1; y <= 1; ++y)
        for (std::int64_t z = -1; z <= 1; ++z) {
          const auto cube = cubes_.find(key({middle[0] + x, middle[1] + y, middle[2] + z}));
          if (cube == cubes_.end()) continue;
          for (std::size_t i = cube->second.first; i < cube->second.second; ++i) found.push_back(members_[i]);
        }
    std::sort(found.begin(), found.end());
  }

 private:
  [[nodiscard]] std::array<std::int64_t, 3> index(const Vec3& p) const {
    return {std::llround(p.x() / size_), std::llround(p.y() / size_), std::llround(p.z() / size_)};
  }
  // Cubes 2^21 apart share a key, which costs time and changes nothing.
  static std::uint64_t key(const std::array<std::int64_t, 3>& i) {
    constexpr std::uint64_t mask = (1U << 21U) - 1U;
    return ((static_cast<std::uint64_t>(i[0]) & mask) << 42U) |
           ((static_cast<std::uint64_t>(i[1]) & mask) << 21U) | (static_cast<std::uint64_t>(i[2]) & mask);
  }

  double size_;
  std::vector<std::uint32_t> members_;
  std::unordered_map<std::uint64_t, std::pair<std::size_t, std::size_t>> cubes_;
};

// The nearest two places of cell a and of the neighbourhood of cell b: Newton's method on the squared
// distance, kept within the cell, and within one cell about b.
void approach(const CubicPath& path_a, const CellPoint& a, const CubicPath& path_b, const CellPoint& b,
              Touch& touch) {
  const double low_a = a.place - 0.5 * a.width, high_a = a.place + 0.5 * a.width;
  double low_b = b.place - 1.5 * b.width, high_b = b.place + 1.5 * b.width;
  if (!path_b.is_periodic()) {
    low_b = std::max(0.0, low_b);
    high_b = std::min(static_cast<double>(path_b.spans()), high_b);
  }
  const auto jet_on_b = [&](double place) {
    CubicPath::Jet jet = path_b.at(place);
    jet.position += touch.shift;
    return jet;
  };
  double s = a.place, t = b.place;
  CubicPath::Jet at_a = path_a.at(s), at_b = jet_on_b(t);
  const auto nearest_on_b = [&] {
    for (int i = 0; i < 3; ++i) {
      const Vec3 apart = at_b.position - at_a.position;
      const double slope = apart.dot(at_b.d1);
      const double bend = std::max(at_b.d1.squaredNorm() + apart.dot(at_b.d2), 0.2 * at_b.d1.squaredNorm());
      t = std::clamp(t - slope / bend, low_b, high_b);
      at_b = jet_on_b(t);
    }
  };
  nearest_on_b();
  for (int i = 0; i < 4; ++i) {
    const Vec3 apart = at_a.position - at_b.position;
    const double slope_a = apart.dot(at_a.d1), slope_b = -apart.dot(at_b.d1);
    const double aa = at_a.d1.squaredNorm() + apart.dot(at_a.d2),
                 bb = std::max(at_b.d1.squaredNorm() - apart.dot(at_b.d2), 0.2 * at_b.d1.squaredNorm()),
                 ab = -at_a.d1.dot(at_b.d1);
    const double reduced = aa - ab * ab / bb, slope = slope_a - ab * slope_b / bb;
    // Where the distance has no minimum in sight the step goes to the better end.
    const double step =
        reduced > 0.02 * at_a.d1.squaredNorm() ? -slope / reduced : (slope > 0 ? -a.width : a.width);
    const double next = std::clamp(s + step, low_a, high_a);
    const bool is_last = std::abs(next - s) < 1e-9 * a.width;
    s = next;
    at_a = path_a.at(s);
    nearest_on_b();
    if (is_last) break;
  }
  touch.place_a = s;
  touch.place_b = t;
  touch.on_a = at_a.position;
  touch.on_b = at_b.position;
}

}  // namespace

CubicPath::CubicPath(const nurbs::Curve& curve, Vec3 period)
    : breaks_(nurbs::breakpoints(curve.knots, curve.degree)),
      period_(std::move(period)),
      is_periodic_(period_ != Vec3::Zero()) {
  std::vector<nurbs::CurveJet> jets;
  jets.reserve(breaks_.size());
  for (const double t : breaks_) jets.push_back(nurbs::evaluate_jet(curve, t));
  pieces_.resize(breaks_.size() - 1);
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    const double h = step(k);
    const Vec3 a = jets[k].position, da = h * jets[k].d1, b = jets[k + 1].position, db = h * jets[k + 1].d1;
    pieces_[k] = {a, da, 3 * (b - a) - 2 * da - db, 2 * (a - b) + da + db};
  }
}

double CubicPath::turns_before(double place) const {
  const auto count = static_cast<double>(pieces_.size());
  if (!is_periodic_ || (place >= 0.0 && place <= count)) return 0;
  return std::floor(place / count);
}

std::size_t CubicPath::span_of(double place) const {
  const double own = place - turns_before(place) * static_cast<double>(pieces_.size());
  return std::min(static_cast<std::size_t>(std::max(own, 0.0)), pieces_.size() - 1);
}

CubicPath::Jet CubicPath::at(double place) const {
  const double turns = turns_before(place), own = place - turns * static_cast<double>(pieces_.size());
  const std::size_t span = std::min(static_cast<std::size_t>(std::max(own, 0.0)), pieces_.size() - 1);
  const double f = own - static_cast<double>(span);
  const std::array<Vec3, 4>& c = pieces_[span];
  return {c[0] + f * (c[1] + f * (c[2] + f * c[3])) + turns * period_, c[1] + f * (2 * c[2] + 3 * f * c[3]),
          2 * c[2] + 6 * f * c[3]};
}

double CubicPath::parameter(double place) const {
  const double own = place - turns_before(place) * static_cast<double>(pieces_.size());
  const std::size_t span = span_of(own);
  return breaks_[span] + step(span) * (own - static_cast<double>(span));
}

TouchFinder::TouchFinder(const MendProblem& problem, const std::vector<CubicPath>& paths)
    : problem_(problem), cells_(paths.size()) {
  for (std::size_t line = 0; line < paths.size(); ++line)
    for (std::size_t span = 0; span < paths[line].spans(); ++span) {
      const auto start = static_cast<double>(span);
      const double chord =
          (paths[line].at(start + 0.5).position - paths[line].at(start).position).norm() +
          (paths[line].at(start + 1.0).position - paths[line].at(start + 0.5).position).norm();
      const int count =
          std::clamp(static_cast<int>(std::ceil(chord / (cell_length * problem.lines[line].radius))), 2, 400);
      for (int i = 0; i < count; ++i) cells_[line].push_back({start + (i + 0.5) / count, 1.0 / count});
    }
}

namespace {

// Of things that repeat by a shift: those so many shifts away or farther are farther than `look` apart.
int copies_within(const Vec3& shift, const std::vector<std::vector<Vec3>>& positions, double look) {
  if (shift == Vec3::Zero()) return 0;
  const Vec3 along = shift.normalized();
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const std::vector<Vec3>& line : positions)
    for (const Vec3& position : line) {
      low = std::min(low, position.dot(along));
      high = std::max(high, position.dot(along));
    }
  return static_cast<int>((high - low + look) / shift.norm());
}

}  // namespace

std::vector<CellPoint> TouchFinder::points_of(const std::vector<CubicPath>& paths, double look) const {
  std::vector<std::vector<Vec3>> positions(paths.size());
  for (std::size_t line = 0; line < paths.size(); ++line)
    for (const Cell& cell : cells_[line]) positions[line].push_back(paths[line].at(cell.place).position);
  std::vector<CellPoint> points;
  const int copies = copies_within(problem_.repeat, positions, look);
  for (int copy = -copies; copy <= copies; ++copy)
    for (std::size_t line = 0; line < paths.size(); ++line) {
      if (copy != 0 && !problem_.lines[line].repeats) continue;
      const int turns = copies_within(paths[line].period(), positions, look);
      double along = 0;
      for (int turn = -turns; turn <= turns; ++turn) {
        const Vec3 shift = copy * problem_.repeat + turn * paths[line].period();
        const double first = static_cast<double>(turn) * static_cast<double>(paths[line].spans());
        for (std::size_t i = 0; i < cells_[line].size(); ++i) {
          const Cell& cell = cells_[line][i];
          const Vec3 position = positions[line][i] + shift;
          if (turn > -turns || i > 0) along += (position - points.back().position).norm();
          points.push_back(
              {line, copy, copy == 0 && turn == 0, first + cell.place, cell.width, along, position});
        }
      }
    }
  return points;
}

std::vector<Touch> TouchFinder::find(const std::vector<CubicPath>& paths, double band) const {
  double widest = 0;
  for (const MendLine& line : problem_.lines) widest = std::max(widest, line.radius);
  // Half a cell may lie between the nearest place and each of the middles.
  const double look = 2.1 * widest + band + 1.5 * cell_length * widest;
  const std::vector<CellPoint> points = points_of(paths, look);
  const Cubes cubes(points, look);
  std::vector<Touch> touches;
  std::vector<std::uint32_t> near;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const CellPoint& a = points[i];
    if (!a.is_own) continue;
    const double own = problem_.apart * problem_.lines[a.line].radius;
    const auto is_apart = [&](std::size_t j) {
      return points[j].line != a.line || points[j].copy != a.copy ||
             std::abs(points[j].along - a.along) > own;
    };
    cubes.near(a.position, near);
    // Cells that follow each other are one part of a line: its nearest one counts, if it is nearer than those
    // on both sides of it.
    for (const std::uint32_t j : near) {
      const double distance = (points[j].position - a.position).squaredNorm();
      if (distance > look * look || !is_apart(j)) continue;
      const auto is_nearer = [&](std::size_t k, bool also_equal) {
        if (points[k].line != points[j].line || points[k].copy != points[j].copy) return false;
        const double other = (points[k].position - a.position).squaredNorm();
        return also_equal ? other <= distance : other < distance;
      };
      if (j > 0 && is_nearer(j - 1, false)) continue;
      if (j + 1 < points.size() && is_nearer(j + 1, true)) continue;
      Touch touch;
      touch.line_a = a.line;
      touch.line_b = points[j].line;
      touch.shift = points[j].copy * problem_.repeat;
      const CubicPath &path_a = paths[a.line], &path_b = paths[touch.line_b];
      approach(path_a, a, path_b, points[j], touch);
      const Vec3 apart = touch.on_a - touch.on_b;
      const double gap = apart.norm();
      if (!(gap > 0.0)) continue;
      touch.normal = apart / gap;
      touch.slack =
          gap -
          reach_of(problem_.lines[touch.line_a], path_a.at(touch.place_a).d1.normalized(), -touch.normal) -
          reach_of(problem_.lines[touch.line_b], path_b.at(touch.place_b).d1.normalized(), touch.normal);
      if (touch.slack < band) touches.push_back(touch);
    }
  }
  return touches;
}

}  // namespace selvage::fabric
