#include "contact/shared_space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <span>

#include "contact/overlay.h"
#include "core/groups.h"

namespace selvage::contact {

namespace {

constexpr int coarse = 24, fine = 40;  // lines along a side of the raster: while searching, for the answer
// Where a line passes through a triangle, going along the direction.
struct Passage {
  std::size_t line = 0;
  double height = 0;
  bool leaves = false;  // out of the yarn
  std::uint32_t triangle = 0;
};

// A skin's vertices in a frame, each seen when it is asked for.
class SeenMesh {
 public:
  SeenMesh(const TriangleRuns& skin, const Axes& frame)
      : skin_(skin),
        frame_(frame),
        points_(skin.mesh().vertices.size()),
        is_seen_(skin.mesh().vertices.size(), 0) {}
  [[nodiscard]] const TriangleRuns& skin() const { return skin_; }

  // Can triangles of the run reach lines over the rectangle?
  [[nodiscard]] bool reaches(const TriangleRuns::Run& run, const Rectangle& lines) const {
    return lines.squaredExteriorDistance(Vec2(frame_.seen(run.middle).head<2>())) <= run.radius * run.radius;
  }
  const std::vector<Vec3>& of(const std::array<std::uint32_t, 3>& triangle) {
    for (const std::uint32_t corner : triangle) {
      if (is_seen_[corner] != 0) continue;
      is_seen_[corner] = 1;
      points_[corner] = frame_.seen(skin_.mesh().vertices[corner]);
    }
    return points_;
  }

 private:
  const TriangleRuns& skin_;
  const Axes& frame_;
  std::vector<Vec3> points_;
  std::vector<char> is_seen_;
};

// Lines along the frame's direction through a skin.
class Rays : public Raster {
 public:
  using Raster::Raster;

  // Every passage of a line through a triangle of the skin, line by line, each going up.
  [[nodiscard]] std::vector<Passage> pass(SeenMesh& seen) const {
    std::vector<Passage> met;
    const Rectangle whole(low, Vec2(low + step * lines));
    const auto& triangles = seen.skin().mesh().triangles;
    for (const TriangleRuns::Run& run : seen.skin().runs()) {
      if (!seen.reaches(run, whole)) continue;
      for (std::uint32_t k = run.begin; k < run.end; ++k) pass(seen.of(triangles[k]), triangles[k], k, met);
    }
    // By lines in one go, as few passages are on each.
    std::vector<std::size_t> ends(size() + 1, 0);
    for (const Passage& passage : met) ++ends[passage.line + 1];
    std::partial_sum(ends.begin(), ends.end(), ends.begin());
    std::vector<Passage> all(met.size());
    for (const Passage& passage : met) all[ends[passage.line]++] = passage;
    for (std::size_t begin = 0, line = 0; begin < all.size(); begin = ends[line++])
      std::sort(all.begin() + static_cast<std::ptrdiff_t>(begin),
                all.begin() + static_cast<std::ptrdiff_t>(ends[line]),
                [](const Passage& x, const Passage& y) {
                  // Coming in before going out where the heights are equal: a piece of no length is no gap.
                  return x.height != y.height ? x.height < y.height : !x.leaves && y.leaves;
                });
    return all;
  }

  // The cells round a line and half of the next ones.
  [[nodiscard]] Rectangle about(std::size_t line) const {
    return {Vec2(place(line) - 1.5 * step), Vec2(place(line) + 1.5 * step)};
  }

 private:
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
    const auto [x0, x1] = std::minmax({seen[t[0]].x(), seen[t[1]].x(), seen[t[2]].x()});
    const auto [y0, y1] = std::minmax({seen[t[0]].y(), seen[t[1]].y(), seen[t[2]].y()});
    const int i0 = first(0, x0), i1 = last(0, x1);
    if (i0 > i1) return;
    const int j0 = first(1, y0), j1 = last(1, y1);
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
        all.push_back({number_of(i, j), height, leaves, k});
      }
    }
  }
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

TriangleRuns::TriangleRuns(const Mesh& mesh) : mesh_(mesh) {
  constexpr std::uint32_t in_a_run = 16;
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  for (std::uint32_t begin = 0; begin < count; begin += in_a_run) {
    Run run{begin, std::min(begin + in_a_run, count), Vec3::Zero(), 0};
    Box3 box;
    for (std::uint32_t k = run.begin; k < run.end; ++k)
      for (const std::uint32_t corner : mesh.triangles[k]) box.extend(mesh.vertices[corner]);
    run.middle = box.center();
    for (std::uint32_t k = run.begin; k < run.end; ++k)
      for (const std::uint32_t corner : mesh.triangles[k])
        run.radius = std::max(run.radius, (mesh.vertices[corner] - run.middle).norm());
    run.radius *= 1 + 1e-6;  // rounding, of the frame too
    runs_.push_back(run);
  }
}

// Both skins in a frame.
class SharedSpace::View {
 public:
  View(const SharedSpace& space, const Vec3& direction)
      : space_(space), frame_(direction, space.walls_), seen_a_(space.a_, frame_), seen_b_(space.b_, frame_) {
    for (const Vec3& p : space.walls_) box_.extend(frame_.seen(p));
  }

  // On a raster, and on a finer one about the line on which they part last: an edge lies between the first
  // one's lines.
  [[nodiscard]] Parting parting(int lines) const {
    const Rectangle whole(Vec2(box_.min().head<2>()), Vec2(box_.max().head<2>()));
    if (!(whole.sizes().minCoeff() > 0.0)) return {};
    const Rays raster(whole, lines);
    const Last last = find_last(raster);
    if (!(last.distance > 0.0)) return {};
    const Rays closer(raster.about(last.in.line), lines);
    const Last closer_last = find_last(closer);
    return closer_last.distance > last.distance ? parting(closer, closer_last) : parting(raster, last);
  }

  [[nodiscard]] std::vector<Parting> late_partings(int lines, double share) const {
    const Rectangle whole(Vec2(box_.min().head<2>()), Vec2(box_.max().head<2>()));
    if (!(whole.sizes().minCoeff() > 0.0)) return {};
    const Rays raster(whole, lines);
    std::vector<Last> last(raster.size());
    double largest = 0;
    for_each_shared(raster, [&](const Chord& x, const Chord& y) {
      Last& here = last[x.in.line];
      if (x.out.height - y.in.height > here.distance) here = {x.out.height - y.in.height, x.out, y.in};
      largest = std::max(largest, here.distance);
    });
    std::vector<Parting> peaks;
    for (std::size_t k = 0; k < last.size(); ++k)
      if (last[k].distance > 0 && last[k].distance >= share * largest &&
          raster.all_about(k, 1, [&](std::size_t other) { return last[other].distance <= last[k].distance; }))
        peaks.push_back(parting(raster, last[k]));
    std::stable_sort(peaks.begin(), peaks.end(),
                     [](const Parting& x, const Parting& y) { return x.distance > y.distance; });
    return peaks;
  }

  // Runs of shared space on lines, joined where neighbouring lines' runs overlap.
  [[nodiscard]] std::vector<std::vector<Vec3>> pieces(int lines) const {
    const Rectangle whole(Vec2(box_.min().head<2>()), Vec2(box_.max().head<2>()));
    if (!(whole.sizes().minCoeff() > 0.0)) return {};
    const Rays raster(whole, lines);
    struct Run {
      std::size_t line;
      double low, high;
    };
    std::vector<Run> runs;
    std::vector<std::size_t> first(raster.size() + 1, 0);
    for_each_shared(raster, [&](const Chord& x, const Chord& y) {
      runs.push_back({x.in.line, std::max(x.in.height, y.in.height), std::min(x.out.height, y.out.height)});
    });
    for (const Run& run : runs) ++first[run.line + 1];
    for (std::size_t k = 1; k < first.size(); ++k) first[k] += first[k - 1];
    Groups groups(runs.size());
    const auto row = static_cast<std::size_t>(lines);
    for (std::size_t k = 0; k < runs.size(); ++k)
      for (const std::size_t step : {std::size_t{1}, row}) {
        const std::size_t next = runs[k].line + step;
        if (next >= raster.size() || (step == 1 && next % row == 0)) continue;
        for (std::size_t m = first[next]; m < first[next + 1]; ++m)
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

  [[nodiscard]] Parting parting(const Rays& raster, const Last& last) const {
    const Vec2 place = raster.place(last.in.line);
    return {last.distance, last.out.triangle, last.in.triangle, frame_.placed(place, last.out.height),
            frame_.placed(place, last.in.height)};
  }

  [[nodiscard]] Last find_last(const Rays& raster) const {
    Last last;
    for_each_shared(raster, [&](const Chord& x, const Chord& y) {
      if (x.out.height - y.in.height > last.distance) last = {x.out.height - y.in.height, x.out, y.in};
    });
    return last;
  }

  // Calls visit(piece of A, piece of B) for those that overlap, line by line.
  template <class Visit>
  void for_each_shared(const Rays& raster, const Visit& visit) const {
    const std::vector<Passage> all_a = raster.pass(seen_a_), all_b = raster.pass(seen_b_);
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
  mutable SeenMesh seen_a_, seen_b_;  // what was seen once
  Box3 box_;                          // of the walls
};

Parting SharedSpace::parting(const Vec3& direction) const {
  return View(*this, direction).parting(fine);
}

std::vector<Parting> SharedSpace::late_partings(const Vec3& direction, double share) const {
  return View(*this, direction).late_partings(fine, share);
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
        for (int k = 0; k < 8; ++k) {
          const Vec3 n = turned(here.n, step, k);
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
