// Where centre lines come near each other.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/vec.h"
#include "fabric/mend.h"
#include "nurbs/spline.h"

namespace selvage::fabric {

// A cubic B-spline as its polynomial pieces. A place is a number: span + share of the span.
class CubicPath {
 public:
  struct Jet {
    Vec3 position, d1, d2;  // derivatives by the place
  };
  explicit CubicPath(const nurbs::Curve& curve);
  [[nodiscard]] std::size_t spans() const { return pieces_.size(); }
  [[nodiscard]] Jet at(double place) const;
  // By the curve's own parameter.
  [[nodiscard]] double parameter(double place) const;
  [[nodiscard]] double step(std::size_t span) const { return breaks_[span + 1] - breaks_[span]; }
  [[nodiscard]] std::size_t span_of(double place) const;

 private:
  std::vector<std::array<Vec3, 4>> pieces_;
  std::vector<double> breaks_;
};

// One cell of a line, with the nearest place of another line, or of another part of its own.
struct Touch {
  std::size_t line_a = 0, line_b = 0;
  double place_a = 0, place_b = 0;
  Vec3 on_a, on_b;
  Vec3 normal;       // unit, from b to a
  double slack = 0;  // distance less what the two yarns reach
};

// The middle of a cell.
struct CellPoint {
  std::size_t line = 0;
  double place = 0, width = 0;  // of the cell, in places
  double along = 0;             // arc length from the line's start
  Vec3 position;
};

// Cells of about a third of the radius, line after line; the same number for the same lines.
class TouchFinder {
 public:
  TouchFinder(const MendProblem& problem, const std::vector<CubicPath>& paths);
  // All touches with a slack below `band`, by cells.
  [[nodiscard]] std::vector<Touch> find(const std::vector<CubicPath>& paths, double band) const;

 private:
  struct Cell {
    std::size_t line = 0;
    double place = 0, width = 0;
  };
  [[nodiscard]] std::vector<CellPoint> points_of(const std::vector<CubicPath>& paths) const;

  const MendProblem& problem_;
  std::vector<Cell> cells_;
};

}  // namespace selvage::fabric
