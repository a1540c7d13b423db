// The passes of a program: loops of one yarn, side by side and made in one direction; each becomes a row of a
// chart. And the courses in which they lie.
#pragma once

#include <vector>

#include "formats/knitout/stitch_graph.h"

namespace selvage::formats::knitout {

struct Pass {
  std::uint32_t carriers = 0;
  int direction = 1;
  std::vector<int> loops;  // in the order in which they were made
  int row = 0;             // of the chart, from 0
};

struct Passes {
  // Needles of both beds stand in turn, since the racking has a fraction: two columns a needle.
  bool is_doubled = false;
  std::vector<Pass> list;    // as they begin; rows of one course are in this order
  std::vector<int> of_loop;  // indices in `list`
  int feeds = 1;             // rows of a course
  int courses = 0;

  [[nodiscard]] int column(const Station& station) const {
    return is_doubled ? 2 * station.column + (station.bed == Bed::back ? 1 : 0) : station.column;
  }
};

// A loop lies in a course above those that it was pulled through, a tuck in no lower one than those that it
// joins. A course has as many rows as most of them need; where there are more, they lie higher.
Passes passes_of(const StitchGraph& graph);

}  // namespace selvage::formats::knitout
