// The stitches of a weft knit, one sign a needle and yarn, repeated over the cloth. A row of the chart is one
// yarn; a course is as many rows as there are feeds, one almost everywhere.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "fabric/model.h"

namespace selvage::fabric {

// Seen from the technical face. A loop is knitted through the loop that its needle held (knit: from the back
// to the face, purl: from the face to the back) and takes its place on the needle; a tuck is laid to it; a
// miss passes behind it. Where needles of two beds stand opposite each other, knit and tuck are those of the
// front bed, purl and back_tuck those of the back bed, each bed holds its own loops, and a miss passes
// between them.
enum class Stitch : char { knit = 'K', purl = 'P', tuck = 'T', back_tuck = 'U', miss = 'M', none = '.' };

inline bool is_loop(Stitch stitch) {
  return stitch == Stitch::knit || stitch == Stitch::purl;
}

inline bool is_tuck(Stitch stitch) {
  return stitch == Stitch::tuck || stitch == Stitch::back_tuck;
}
// 1: front, -1: back, 0: none.
inline int bed_of(Stitch stitch) {
  if (stitch == Stitch::miss || stitch == Stitch::none) return 0;
  return stitch == Stitch::purl || stitch == Stitch::back_tuck ? -1 : 1;
}

// Courses over which a loop can stay on its needle: tucks and misses one above the other in one wale.
inline constexpr int max_held = 6;

class Journeys;

class StitchChart {
 public:
  // jersey: knit everywhere. purl: courses of knit and purl in turn, the first one knit (1 x 1 purl, links
  // and links). rib a x b: a wales of knit and b of purl in turn. Cardigans and Milano ribs: 1x1 ribs with
  // tucks or misses in courses. interlock: two 1x1 ribs through each other on opposite needles, two feeds.
  // jacquard: one feed a thread, which knits where its number stands and misses elsewhere. Rows of a chart:
  // top row = last one. Errors: (malformed) a chart without rows, ragged rows or unknown signs, rib numbers
  // below 1; (geometry) a loop that would be held for longer than max_held courses, at the chart's row, a
  // jacquard that lacks a thread, and those of Journeys::of.
  static Result<StitchChart> of(const Knit& knit);

  // Any whole numbers, from 0 (course 0 is the first one, wale 0 the left one): the chart repeats both ways.
  [[nodiscard]] Stitch at(long long course, long long wale) const;
  // What the needle of one bed does: misses where the yarn goes to the other one. With beds of their own
  // wales both are the same needle.
  [[nodiscard]] Stitch at(long long course, long long wale, int bed) const;
  [[nodiscard]] bool is_opposite() const { return is_opposite_; }
  [[nodiscard]] int feeds() const { return feeds_; }
  // Of a row above row 0, in courses. The yarns of a course follow each other evenly; those of a jacquard are
  // crowded, for the loops of a course are one row of the pattern; so are those of a whole cloth's chart
  // where none is drawn through another one of its course.
  [[nodiscard]] double height(long long row) const;
  [[nodiscard]] int courses() const { return courses_; }  // of one repeat
  [[nodiscard]] int wales() const { return wales_; }
  // The smallest repeat of the stitches, which may be a part of the chart's.
  [[nodiscard]] long long repeat_of_courses() const;
  [[nodiscard]] long long repeat_of_wales() const;
  // Tucks and misses one above the other, the most that there are in a wale.
  [[nodiscard]] int longest_hold() const { return longest_hold_; }
  // Of a chart that is the whole cloth and does not repeat; null: it does.
  [[nodiscard]] const Journeys* journeys() const { return journeys_.get(); }

 private:
  Status fill(const Knit& knit);
  void fill(std::vector<std::string> rows);  // bottom row first
  Status fill_jacquard(const Knit& knit);
  Status measure_holding(const Knit& knit, int wale, int bed);

  int courses_ = 0, wales_ = 0, longest_hold_ = 0, feeds_ = 1;
  bool is_opposite_ = false;
  double feed_step_ = 1;          // from one row of a course to the next, in courses
  std::vector<Stitch> stitches_;  // courses x wales, first course first
  std::shared_ptr<const Journeys> journeys_;
};

}  // namespace selvage::fabric
