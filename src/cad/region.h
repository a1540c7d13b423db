// Which part of its surface's parameters a face has, by its loops in the parameters, or where those are given
// in space only, by the surface's points that are nearest to theirs.
#pragma once

#include <array>
#include <vector>

#include "cad/distance.h"
#include "cad/model.h"

namespace selvage::cad {

// By polygons along the loops: a place next to them may be told wrongly, by what the polygons cut off.
class Region {
 public:
  explicit Region(const Face& face);

  // False where there are no loops, or these do not tell which side of them is the face: all of the surface
  // is taken for the face's then.
  [[nodiscard]] bool is_known() const { return is_known_; }
  // Holds it; the whole domain where it is not known, or goes round the surface.
  [[nodiscard]] const Range& range() const { return range_; }
  [[nodiscard]] bool contains(double u, double v) const;
  // False: nothing of the range is the face's.
  [[nodiscard]] bool may_meet(const Range& range) const;

 private:
  struct Segment {
    std::array<double, 2> from, to;
  };
  [[nodiscard]] bool contains_as_it_is(double u, double v) const;
  // What brings parameters `first` to `last` to where the segments are, turns round the surface (0 in a
  // direction that is not closed).
  [[nodiscard]] std::vector<double> turns(std::size_t d, double first, double last) const;

  std::vector<Segment> segments_;
  Range range_;
  bool is_known_ = false;
  bool is_all_but_ = false;                        // the face is beyond the segments, up to a pole
  bool along_v_ = false;                           // rays run along v: loops go round the surface in u
  std::array<double, 2> periods_ = {0, 0};         // 0: not closed
  std::array<std::array<double, 2>, 2> extent_{};  // of the segments, in u and in v
  std::array<double, 2> near_ = {0, 0};            // what counts as no width
};

}  // namespace selvage::cad
