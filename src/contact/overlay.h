// Two facing sheets of surface seen along one direction: how deep each line along it lies in both.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "contact/face.h"

namespace selvage::contact {

// A rectangle of a cell's parameters.
struct Part {
  std::uint32_t cell = 0;
  Vec2 low = Vec2::Zero(), high = Vec2::Zero();
};

// Parts of one yarn's surface as points, steps x steps quads each.
struct Sheet {
  std::vector<Part> parts;
  int steps = 0;
  std::vector<Vec3> points;  // (steps + 1)^2 a part, u fastest

  Sheet(const CellModel& model, std::vector<Part> parts, int steps);
  [[nodiscard]] std::size_t points_a_part() const {
    return static_cast<std::size_t>(steps + 1) * static_cast<std::size_t>(steps + 1);
  }
};

// Unit axes, right-handed; `n` is what is looked along.
struct Axes {
  Vec3 x, y, n;

  // x along the longest way of the points as seen along n.
  Axes(const Vec3& n, const std::vector<Vec3>& points);
  [[nodiscard]] Vec3 seen(const Vec3& p) const { return {p.dot(x), p.dot(y), p.dot(n)}; }
  [[nodiscard]] Vec3 placed(const Vec2& p, double height) const { return p.x() * x + p.y() * y + height * n; }
};

// The unit vector `n` turned by about `step` (a tangent) toward the k-th of eight sides. For a compass
// search: steps of other sizes go between these sides, as a fixed pattern gets stuck where two places part
// last together.
Vec3 turned(const Vec3& n, double step, int k);

using Rectangle = Eigen::AlignedBox2d;

// lines x lines lines through the cells of a rectangle: line j * lines + i in column i of row j. They pass
// off the middles by an odd amount, so that none meets an edge of a regular grid on purpose.
struct Raster {
  static constexpr double offset = 0.5 + 0.01234567;
  int lines;
  Vec2 low, step;  // the rectangle's corner; the cells' size

  Raster(const Rectangle& rectangle, int lines_a_side)
      : lines(lines_a_side), low(rectangle.min()), step((rectangle.max() - rectangle.min()) / lines_a_side) {}
  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(lines) * static_cast<std::size_t>(lines);
  }
  [[nodiscard]] std::size_t number_of(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(lines) + static_cast<std::size_t>(i);
  }
  [[nodiscard]] Vec2 place(int i, int j) const {
    return low + step.cwiseProduct(Vec2(i + offset, j + offset));
  }
  [[nodiscard]] Vec2 place(std::size_t line) const {
    const int k = static_cast<int>(line);
    return place(k % lines, k / lines);
  }
  // Whether it holds of all lines up to `radius` steps from this one, itself included.
  template <class Holds>
  bool all_about(std::size_t line, int radius, const Holds& holds) const {
    const int i = static_cast<int>(line) % lines, j = static_cast<int>(line) / lines;
    for (int y = std::max(0, j - radius); y <= std::min(lines - 1, j + radius); ++y)
      for (int x = std::max(0, i - radius); x <= std::min(lines - 1, i + radius); ++x)
        if (!holds(number_of(x, y))) return false;
    return true;
  }
  // The first column (or row) whose lines are at or above a coordinate, and the last one at or below; `lines`
  // and -1 where there is none. What is cast is >= 0: no call of ceil().
  [[nodiscard]] int first(Eigen::Index axis, double from) const {
    const double at = std::clamp((from - low[axis]) / step[axis] - offset, 0.0, static_cast<double>(lines));
    const int below = static_cast<int>(at);
    return below < at ? below + 1 : below;
  }
  [[nodiscard]] int last(Eigen::Index axis, double to) const {
    return static_cast<int>(
               std::clamp((to - low[axis]) / step[axis] - offset + 1.0, 0.0, static_cast<double>(lines))) -
           1;
  }
};

// Lines along `n` on a raster of lines x lines over a rectangle: the highest way out of A and the lowest way
// into B on each. Lines on which all of A lies above all of B (as at the tips of two lenses) count as not
// met.
class Overlay {
 public:
  Overlay(const CellModel& model, const Sheet& a, const Sheet& b, const Axes& axes,
          const Rectangle& rectangle, int lines);

  [[nodiscard]] const Raster& raster() const { return raster_; }
  [[nodiscard]] std::size_t size() const { return a_.size(); }
  [[nodiscard]] const Axes& axes() const { return axes_; }
  // Both sheets are met.
  [[nodiscard]] bool is_met(std::size_t line) const { return a_[line].part >= 0 && b_[line].part >= 0; }
  // How far the two overlap on the line; below 0: minus the gap.
  [[nodiscard]] double depth(std::size_t line) const { return a_[line].height - b_[line].height; }
  // No neighbour is deeper; among equal ones the first.
  [[nodiscard]] bool is_peak(std::size_t line) const;

  struct Place {
    std::uint32_t cell = 0;
    Vec2 site = Vec2::Zero();
    Vec3 point = Vec3::Zero();
  };
  [[nodiscard]] Place on_a(std::size_t line) const { return place(a_[line], sheet_a_, line); }
  [[nodiscard]] Place on_b(std::size_t line) const { return place(b_[line], sheet_b_, line); }

  [[nodiscard]] Vec2 centre(std::size_t line) const { return raster_.place(line); }
  [[nodiscard]] const Vec2& step() const { return raster_.step; }
  [[nodiscard]] int line_at(const Vec2& p) const;  // -1: outside
  // For each line the number of its connected region of overlapping lines (from 0), or -1.
  [[nodiscard]] std::vector<int> regions(double least_depth, int& count) const;
  // The parts of both sheets that lines within `radius` steps of this one meet, with half a step more.
  [[nodiscard]] std::vector<Part> parts_about(std::size_t line, int radius, bool of_a) const;
  // One sheet's normals within `radius` steps of a line are nearly one.
  [[nodiscard]] bool is_smooth_about(std::size_t line, int radius, bool of_a) const;

 private:
  struct Hit {
    double height = 0;
    std::int32_t part = -1;
    float s = 0, t = 0;  // 0 .. 1 within the part
  };
  // What a pass through the triangles keeps of each line.
  enum class Keep { highest_out, lowest_in, highest_in_below, lowest_out_above };
  void pass(const Sheet& sheet, Keep keep, const std::vector<Hit>& bound, std::vector<Hit>& hits) const;
  void pass(const std::array<Vec3, 3>& seen, const std::array<Vec2, 3>& places, std::int32_t part, Keep keep,
            const std::vector<Hit>& bound, std::vector<Hit>& hits) const;
  void drop_passing();
  [[nodiscard]] Place place(const Hit& hit, const Sheet& sheet, std::size_t line) const;

  const CellModel& model_;
  const Sheet& sheet_a_;
  const Sheet& sheet_b_;
  Axes axes_;
  Raster raster_;
  std::vector<Hit> a_, b_;
};

// The line along `n` on which two sheets are deepest in each other, by rasters that close in on it: first of
// the size `reach` about `start`. Nothing: no line meets both. `slack`: what the quads of the first raster
// can change a depth by; where no finer raster can show an overlap this ends early, with a depth below 0.
struct Deepest {
  Overlay::Place a, b;
  double depth = 0;
  // The outward normals of the cells that the last raster saw next to it: where all are nearly the same, the
  // surface is smooth there.
  bool smooth_a = true, smooth_b = true;
};
std::optional<Deepest> close_in(const CellModel& model, std::vector<Part> a, std::vector<Part> b,
                                const Vec3& n, const Vec3& start, double reach,
                                double slack = std::numeric_limits<double>::infinity());

}  // namespace selvage::contact
