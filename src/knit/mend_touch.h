// Where centre lines come near each other.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/vec.h"
#include "knit/mend.h"
#include "nurbs/spline.h"

namespace selvage::fabric {

// A cubic B-spline as its polynomial pieces. A place is a number: span + share of the span. With a period the
// path goes on before its first place and after its last one, shifted by the period each time.
class CubicPath {
 public:
  struct Jet {
    Vec3 position, d1, d2;  // derivatives by the place
  };
  explicit CubicPath(const nurbs::Curve& curve, Vec3 period = Vec3::Zero());
  [[nodiscard]] std::size_t spans() const { return pieces_.size(); }
  [[nodiscard]] Jet at(double place) const;
  // By the curve's own parameter.
  [[nodiscard]] double parameter(double place) const;
  [[nodiscard]] double step(std::size_t span) const { return breaks_[span + 1] - breaks_[span]; }
  [[nodiscard]] std::size_t span_of(double place) const;
  [[nodiscard]] const Vec3& period() const { return period_; }
  [[nodiscard]] bool is_periodic() const { return is_periodic_; }

 private:
  // Whole periods before a place; none in a path that ends.
  [[nodiscard]] double turns_before(double place) const;

  std::vector<std::array<Vec3, 4>> pieces_;
  std::vector<double> breaks_;
  Vec3 period_;
  bool is_periodic_;
};

// One cell of a line, with the nearest place of another line, of another part of its own, or of a copy.
struct Touch {
  std::size_t line_a = 0, line_b = 0;
  double place_a = 0, place_b = 0;
  Vec3 shift = Vec3::Zero();  // of the copy of line b
  Vec3 on_a, on_b;
  Vec3 normal;       // unit, from b to a
  double slack = 0;  // distance less what the two yarns reach
};

// The middle of a cell, of a line or of a copy of it.
struct CellPoint {
  std::size_t line = 0;
  int copy = 0;                 // how often MendProblem::repeat lies between the line and this copy
  bool is_own = false;          // of the line itself, and not of what goes on from it
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
    double place = 0, width = 0;
  };
  // All lines' cells, and those of as many copies as come within `look` of them; each copy of a line as one
  // row, from its start to its end.
  [[nodiscard]] std::vector<CellPoint> points_of(const std::vector<CubicPath>& paths, double look) const;

  const MendProblem& problem_;
  std::vector<std::vector<Cell>> cells_;  // of each line
};

}  // namespace selvage::fabric
