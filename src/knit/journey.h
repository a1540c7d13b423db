// The ways of the loops of a weft knit whose chart is the whole cloth: from the needle where each was made to
// the needle where it is knitted off, which a transfer makes another one; over another loop or under it; and
// together with which others.
#pragma once

#include <cstddef>
#include <vector>

#include "core/diagnostics.h"
#include "fabric/model.h"
#include "knit/chart.h"

namespace selvage::fabric {

// Of a loop or a tuck.
struct Journey {
  int off = -1;   // the row of the loop that is drawn through it; -1: none is
  int right = 0;  // wales to the right, where it is then
  int index = 0;  // among the `count` through which that loop is drawn, from the face of that loop on
  int count = 1;
  int lift = 0;  // 1: it passes before others that it crosses on its way, -1: behind, seen from the face
};

// What a loop is drawn through: the first of so many.
struct Held {
  int row = -1, wale = 0;
  int count = 0;
};

// Wales that one row has from its first stitch to its last; none where first > last.
struct WaleSpan {
  int first = 0, last = -1;
};

// Wales that a loop can be moved by.
inline constexpr int most_moved = 12;

class Journeys {
 public:
  // A chart with signs '.', or whose loops are moved, is the whole cloth.
  static bool are_needed(const Knit& knit);
  // Errors: (malformed) the chart is not as large as the cloth, '.' between stitches of a row, moves of what
  // is no stitch, beyond the cloth, or farther than most_moved; (geometry) a loop held over more than
  // max_held courses, and a cloth without stitches.
  static Result<Journeys> of(const StitchChart& chart, const Knit& knit);

  [[nodiscard]] const Journey& at(long long row, long long wale) const { return journeys_[cell(row, wale)]; }
  [[nodiscard]] const Held& held(long long row, long long wale) const { return held_[cell(row, wale)]; }
  // The stitch that says on which side of the cloth a tuck lies: the first of those that it joins, else the
  // loop that is drawn through it, or itself.
  [[nodiscard]] Stitch joined(const StitchChart& chart, long long row, long long wale) const;
  [[nodiscard]] const WaleSpan& span(long long row) const { return spans_[static_cast<std::size_t>(row)]; }
  [[nodiscard]] int longest_hold() const { return longest_hold_; }
  // Is a loop drawn through one of the same course, of another feed?
  [[nodiscard]] bool knits_within_courses() const { return knits_within_courses_; }

 private:
  Status read_spans(const StitchChart& chart, const Knit& knit);
  Status follow(const StitchChart& chart, const Knit& knit);
  void stack(const StitchChart& chart);
  void cross(const StitchChart& chart);
  [[nodiscard]] std::size_t cell(long long row, long long wale) const {
    return static_cast<std::size_t>(row) * wales_ + static_cast<std::size_t>(wale);
  }

  std::size_t wales_ = 0;
  std::vector<Journey> journeys_;  // rows x wales
  std::vector<Held> held_;         // the same
  std::vector<WaleSpan> spans_;    // of rows
  std::vector<int> order_;         // of each cell among the moves; -1: it is not moved
  int longest_hold_ = 0;
  bool knits_within_courses_ = false;
};

}  // namespace selvage::fabric
