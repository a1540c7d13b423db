// The stitches of a weft knit, one sign a needle and course, repeated over the cloth.
#pragma once

#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "fabric/model.h"

namespace selvage::fabric {

// Seen from the technical face. A loop is knitted through the loop that its needle held (knit: from the back
// to the face, purl: from the face to the back) and takes its place on the needle; a tuck is laid to it; a
// miss passes behind it.
enum class Stitch : char { knit = 'K', purl = 'P', tuck = 'T', miss = 'M' };

inline bool is_loop(Stitch stitch) {
  return stitch == Stitch::knit || stitch == Stitch::purl;
}

// Courses over which a loop can stay on its needle: tucks and misses one above the other in one wale.
inline constexpr int max_held = 6;

class StitchChart {
 public:
  // jersey: knit everywhere. purl: courses of knit and purl in turn, the first one knit (1 x 1 purl, links
  // and links). rib a x b: a wales of knit and b of purl in turn. Rows of a chart: top row = last course.
  // Errors: (malformed) a chart without rows, ragged rows or unknown signs, rib numbers below 1; (geometry) a
  // loop that would be held for longer than max_held courses, at the chart's row.
  static Result<StitchChart> of(const Knit& knit);

  // Any whole numbers, from 0 (course 0 is the first one, wale 0 the left one): the chart repeats both ways.
  [[nodiscard]] Stitch at(long long course, long long wale) const;
  [[nodiscard]] int courses() const { return courses_; }  // of one repeat
  [[nodiscard]] int wales() const { return wales_; }
  // The smallest repeat of the stitches, which may be a part of the chart's.
  [[nodiscard]] long long repeat_of_courses() const;
  [[nodiscard]] long long repeat_of_wales() const;
  // Tucks and misses one above the other, the most that there are in a wale.
  [[nodiscard]] int longest_hold() const { return longest_hold_; }

 private:
  Status fill(const Knit& knit);
  Status measure_holding(const Knit& knit, int wale);

  int courses_ = 0, wales_ = 0, longest_hold_ = 0;
  std::vector<Stitch> stitches_;  // courses x wales, first course first
};

}  // namespace selvage::fabric
