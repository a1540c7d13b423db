#include "contact/shared_space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <span>

#include "contact/overlay.h"
#include "core/groups.h"

namespace selvage::contact {

namespace {

constexpr int coarse = 24, fine = 40;  // lines along a side of the raster: while searching, for the answer
// Off the middle of the raster's cells by an odd amount, so that no line meets an edge of a regular grid on
// purpose.
constexpr double offset = 0.5 + 0.01234567;

// Where a line passes through a triangle, going along the direction.
struct Passage {
  int line = 0;
  double height = 0;
  bool leaves = false;  // out of the yarn
  std::uint32_t triangle = 0;
};

// Lines along the frame's direction.
class Raster {
 public:
  Raster(const Rectangle& rectangle, int lines)
      : lines_(lines), low_(rectangle.min()), step_((rectangle.max() - rectangle.min()) / lines) {}

  // Every passage of a line through a triangle of the skin, line by line, each going up. `seen`: its vertices
  // in the frame.
  [[nodiscard]] std::vector<Passage> pass(const Mesh& skin, const std::vector<Vec3>& seen) const {
    std::vector<Passage> met;
    for (std::uint32_t k = 0; k < skin.triangles.size(); ++k) pass(seen, skin.triangles[k], k, met);
    // By lines in one go, as few passages are on each.
    std::vector<std::size_t> ends(static_cast<std::size_t>(lines_) * static_cast<std::size_t>(lines_) + 1, 0);
    for (const Passage& passage : met) ++ends[static_cast<std::size_t>(passage.line) + 1];
    std::partial_sum(ends.begin(), ends.end(), ends.begin());
    std::vector<Passage> all(met.size());
    for (const Passage& passage : met) all[ends[static_cast<std::size_t>(passage.line)]++] = passage;
    for (std::size_t begin = 0, line = 0; begin < all.size(); begin = ends[line++])
      std::sort(all.begin() + static_cast<std::ptrdiff_t>(begin),
                all.begin() + static_cast<std::ptrdiff_t>(ends[line]),
                [](const Passage& x, const Passage& y) {
                  // Coming in before going out where the heights are equal: a piece of no length is no gap.
                  return x.height != y.height ? x.height < y.height : !x.leaves && y.leaves;
                });
    return all;
  }

  [[nodiscard]] Vec2 place(int line) const { return place(line % lines_, line / lines_); }

  // The cells round a line and half of the next ones.
  [[nodiscard]] Rectangle about(int line) const {
    return {Vec2(place(line) - 1.5 * step_), Vec2(place(line) + 1.5 * step_)};
  }

 private:
  [[nodiscard]] Vec2 place(int i, int j) const {
    return low_ + step_.cwiseProduct(Vec2(i + offset, j + offset));
  }

  // Twice the area of (a, b, p), with the same absolute value whichever of a and b comes first: a line beside
  // a common edge is on one side of it for both triangles.
  static double side(const std::vector<Vec3>& seen, std::uint32_t a, std::uint32_t b, const Vec2& p) {
    const bool swap = b < a;
    const Vec3 &s = seen[swap ? b : a], &e = seen[swap ? a : b];
    double area = (e.x() - s.x()) * (p.y() - s.y()) - (e.y() - s.y()) * (p.x() - s.x());
    if (area == 0.0) area = std::numeric_limits<double>::min();
    return swap ? -area : area;
  }

  struct Interval {
    double low = std::numeric_limits<double>::infinity(), high = -low;
  };
  // Where a triangle is at this height of the raster, to rounding; low > high: nowhere.
  static Interval row(const std::vector<Vec3>& seen, const std::array<std::uint32_t, 3>& t, double y) {
    Interval x;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3 &s = seen[t[c]], &e = seen[t[(c + 1) % 3]];
      if (std::min(s.y(), e.y()) > y || std::max(s.y(), e.y()) < y) continue;
      const double share = s.y() == e.y() ? 0.0 : (y - s.y()) / (e.y() - s.y());
      const double at = s.x() + share * (e.x() - s.x());
      x.low = std::min(x.low, at);
      x.high = std::max(x.high, at);
    }
    return x;
  }

  void pass(const std::vector<Vec3>& seen, const std::array<std::uint32_t, 3>& t, std::uint32_t k,
            std::vector<Passage>& all) const {
    Vec2 low = seen[t[0]].head<2>(), high = low;
    for (std::size_t c = 1; c < 3; ++c) {
      low = low.cwiseMin(seen[t[c]].head<2>());
      high = high.cwiseMax(seen[t[c]].head<2>());
    }
    const auto first = [&](int axis, double from) {
      return static_cast<int>(
          std::clamp(std::ceil((from - low_[axis]) / step_[axis] - offset), 0.0, lines_ + 0.0));
    };
    const auto last = [&](int axis, double to) {
      return static_cast<int>(
          std::clamp(std::floor((to - low_[axis]) / step_[axis] - offset), -1.0, lines_ - 1.0));
    };
    const int i0 = first(0, low.x()), i1 = last(0, high.x());
    if (i0 > i1) return;
    const int j0 = first(1, low.y()), j1 = last(1, high.y());
    for (int j = j0; j <= j1; ++j) {
      // Of long triangles that lie across most lines of the box are outside; a line more on either side
      // leaves the answer to the signs.
      const Interval x = row(seen, t, place(0, j).y());
      const int end = std::min(i1, last(0, x.high) + 1);
      for (int i = std::max(i0, first(0, x.low) - 1); i <= end; ++i) {
        const Vec2 p = place(i, j);
        const double w0 = side(seen, t[1], t[2], p), w1 = side(seen, t[2], t[0], p),
                     w2 = side(seen, t[0], t[1], p);
        const bool leaves = w0 > 0.0;  // seen against the direction the corners run counter-clockwise
        if ((w1 > 0.0) != leaves || (w2 > 0.0) != leaves) continue;
        const double height =
            (w0 * seen[t[0]].z() + w1 * seen[t[1]].z() + w2 * seen[t[2]].z()) / (w0 + w1 + w2);
        all.push_back({j * lines_ + i, height, leaves, k});
      }
    }
  }

  int lines_;
  Vec2 low_, step_;
};

// What lies inside a skin on a line.
struct Chord {
  Passage in, out;
};

using Passages = std::span<const Passage>;

// The pieces of a line inside a closed skin.
void find_pieces(Passages passages, std::vector<Chord>& pieces) {
  int depth = 0;
  Passage in;
  for (const Passage& passage : passages) {
    if (!passage.leaves && depth++ == 0) in = passage;
    if (passage.leaves && --depth == 0) pieces.push_back({in, passage});
    depth = std::max(depth, 0);
  }
}

// The next line's passages, from `begin` on.
Passages next_line(const std::vector<Passage>& all, std::size_t begin) {
  std::size_t end = begin;
  while (end < all.size() && all[end].line == all[begin].line) ++end;
  return Passages(all).subspan(begin, end - begin);
}

}  // namespace

// Both skins in a frame.
class SharedSpace::View {
 public:
  View(const SharedSpace& space, const Vec3& direction) : space_(space), frame_(direction, space.walls_) {
    const auto see = [this](const std::vector<Vec3>& points) {
      std::vector<Vec3> seen;
      seen.reserve(points.size());
      for (const Vec3& p : points) seen.push_back(frame_.seen(p));
      return seen;
    };
    seen_a_ = see(space.a_.vertices);
    seen_b_ = see(space.b_.vertices);
    for (const Vec3& p : space.walls_) box_.extend(frame_.seen(p));
  }

  // On a raster, and on a finer one about the line on which they part last: an edge lies between the first
  // one's lines.
  [[nodiscard]] Parting parting(int lines) const {
    const Rectangle whole(Vec2(box_.min().head<2>()), Vec2(box_.max().head<2>()));
    if (!(whole.sizes().minCoeff() > 0.0)) return {};
    const Raster raster(whole, lines);
    const Last last = find_last(raster);
    if (!(last.distance > 0.0)) return {};
    const Raster closer(raster.about(last.in.line), lines);
    const Last closer_last = find_last(closer);
    return closer_last.distance > last.distance ? parting(closer, closer_last) : parting(raster, last);
  }

  // Runs of shared space on lines, joined where neighbouring lines' runs overlap.
  [[nodiscard]] std::vector<std::vector<Vec3>> pieces(int lines) const {
    const Rectangle whole(Vec2(box_.min().head<2>()), Vec2(box_.max().head<2>()));
    if (!(whole.sizes().minCoeff() > 0.0)) return {};
    const Raster raster(whole, lines);
    struct Run {
      int line;
      double low, high;
    };
    std::vector<Run> runs;
    std::vector<std::size_t> first(static_cast<std::size_t>(lines) * static_cast<std::size_t>(lines) + 1, 0);
    for_each_shared(raster, [&](const Chord& x, const Chord& y) {
      runs.push_back({x.in.line, std::max(x.in.height, y.in.height), std::min(x.out.height, y.out.height)});
    });
    for (const Run& run : runs) ++first[static_cast<std::size_t>(run.line) + 1];
    for (std::size_t k = 1; k < first.size(); ++k) first[k] += first[k - 1];
    Groups groups(runs.size());
    for (std::size_t k = 0; k < runs.size(); ++k)
      for (const int step : {1, lines}) {
        const int next = runs[k].line + step;
        if (next >= lines * lines || (step == 1 && next % lines == 0)) continue;
        for (std::size_t m = first[static_cast<std::size_t>(next)];
             m < first[static_cast<std::size_t>(next) + 1]; ++m)
          if (runs[m].low <= runs[k].high && runs[k].low <= runs[m].high) groups.join(k, m);
      }
    std::map<std::size_t, std::vector<Vec3>> walls;
    for (std::size_t k = 0; k < runs.size(); ++k) {
      std::vector<Vec3>& of_piece = walls[groups.of(k)];
      const Vec2 place = raster.place(runs[k].line);
      of_piece.push_back(frame_.placed(place, runs[k].low));
      of_piece.push_back(frame_.placed(place, runs[k].high));
    }
    std::vector<std::vector<Vec3>> all;
    all.reserve(walls.size());
    for (auto& [group, points] : walls) all.push_back(std::move(points));
    return all;
  }

 private:
  struct Last {
    double distance = 0;
    Passage out, in;  // of A, into B
  };

  [[nodiscard]] Parting parting(const Raster& raster, const Last& last) const {
    const Vec2 place = raster.place(last.in.line);
    return {last.distance, last.out.triangle, last.in.triangle, frame_.placed(place, last.out.height),
            frame_.placed(place, last.in.height)};
  }

  [[nodiscard]] Last find_last(const Raster& raster) const {
    Last last;
    for_each_shared(raster, [&](const Chord& x, const Chord& y) {
      if (x.out.height - y.in.height > last.distance) last = {x.out.height - y.in.height, x.out, y.in};
    });
    return last;
  }

  // Calls visit(piece of A, piece of B) for those that overlap, line by line.
  template <class Visit>
  void for_each_shared(const Raster& raster, const Visit& visit) const {
    const std::vector<Passage> all_a = raster.pass(space_.a_, seen_a_),
                               all_b = raster.pass(space_.b_, seen_b_);
    std::vector<Chord> pieces_a, pieces_b;
    for (std::size_t i = 0, j = 0; i < all_a.size() && j < all_b.size();) {
      const Passages a = next_line(all_a, i), b = next_line(all_b, j);
      if (a.front().line <= b.front().line) i += a.size();
      if (b.front().line <= a.front().line) j += b.size();
      if (a.front().line != b.front().line) continue;
      pieces_a.clear();
      pieces_b.clear();
      find_pieces(a, pieces_a);
      find_pieces(b, pieces_b);
      for (const Chord& x : pieces_a)
        for (const Chord& y : pieces_b)
          if (is_shared(x, y)) visit(x, y);
    }
  }

  [[nodiscard]] bool is_shared(const Chord& a, const Chord& b) const {
    const double top = std::min(a.out.height, b.out.height), bottom = std::max(a.in.height, b.in.height);
    return top - bottom > space_.grain_ && top >= box_.min().z() && bottom <= box_.max().z();
  }

  const SharedSpace& space_;
  Axes frame_;
  std::vector<Vec3> seen_a_, seen_b_;
  Box3 box_;  // of the walls
};

Parting SharedSpace::parting(const Vec3& direction) const {
  return View(*this, direction).parting(fine);
}

std::vector<std::vector<Vec3>> SharedSpace::pieces(const Vec3& direction) const {
  return View(*this, direction).pieces(2 * coarse);
}

Vec3 SharedSpace::easiest_direction(const std::vector<Vec3>& starts) const {
  // A direction in which nothing is seen says nothing.
  const auto cost = [this](const Vec3& n) {
    const double distance = View(*this, n).parting(coarse).distance;
    return distance > 0.0 ? distance : std::numeric_limits<double>::infinity();
  };
  struct Start {
    Vec3 n;
    double cost;
  };
  std::vector<Start> list;
  list.reserve(starts.size());
  for (const Vec3& n : starts) list.push_back({n, cost(n)});
  std::stable_sort(list.begin(), list.end(), [](const Start& x, const Start& y) { return x.cost < y.cost; });
  list.resize(std::min<std::size_t>(list.size(), 3));
  Start best = list.front();
  for (Start here : list) {
    double step = 0.3;
    for (int halving = 0; halving < 7; ++halving, step *= 0.5) {
      for (bool moved = true; moved;) {
        moved = false;
        const Vec3 x = here.n.unitOrthogonal(), y = here.n.cross(x);
        for (int k = 0; k < 8; ++k) {
          // Turned from step size to step size: a fixed pattern gets stuck where two places part last
          // together.
          const double angle = k * std::numbers::pi / 4.0 + 10.0 * step;
          const Vec3 n = (here.n + step * (std::cos(angle) * x + std::sin(angle) * y)).normalized();
          const double value = cost(n);
          // Less than this is the raster's grain.
          if (value < here.cost * (1.0 - 1e-5)) {
            here = {n, value};
            moved = true;
            break;
          }
        }
      }
    }
    if (here.cost < best.cost) best = here;
  }
  return best.n;
}

std::vector<Vec3> directions_all_round() {
  std::vector<Vec3> all;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (x != 0 || y != 0 || z != 0) all.push_back(Vec3(x, y, z).normalized());
  return all;
}

}  // namespace selvage::contact
