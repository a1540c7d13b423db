// What moves the loops of a weft knit apart: the published loop is not free of overlap (methods.md, 1), and
// tucks and floats of our own charts meet their neighbours as well.
#pragma once

#include <cstddef>
#include <vector>

#include "core/vec.h"
#include "knit/loop.h"
#include "knit/mend.h"
#include "nurbs/interpolate.h"
#include "yarn/path.h"
#include "yarn/section.h"

namespace selvage::fabric {

// How a course goes on beyond its ends.
struct Onward {
  // As its outermost points again and again, so many of them, each time this far on. 0: as its own image in
  // the planes x = const through its first and its last point.
  std::size_t points = 0;
  Vec3 period = Vec3::Zero();
};

// The centre line of a course through its data points.
yarn::CentreLine course_line(const std::vector<Vec3>& points, nurbs::Parameterization how,
                             const Onward& onward = {});

// Relaxed loops take uniform parameters, which do not change as their points move.
nurbs::Parameterization method_of(const Knit& knit);

struct KnitYarn {
  nurbs::Parameterization how = nurbs::Parameterization::chord;
  yarn::Section section;
  Vec2 half = Vec2::Ones();   // of the section: across, and through the thickness; file units
  bool turns = false;         // the section turns along the path
  double gap = 0;             // wanted between two surfaces, file units
  bool keeps_length = false;  // courses become neither longer nor shorter
  bool relaxes = false;       // loops bend as little as they can, all alike where the chart has them so
};

// Which loops move alike along one direction of the cloth: near its edges every one for itself, inside those
// that are a whole number of repeats apart. What is solved is a reduced cloth, in which all loops of a class
// have the neighbours that they have in the whole one. Where all loops are alike it is a single one, with its
// own copies for neighbours: at the edges some of them are missing, so that nothing there is nearer.
class LoopTies {
 public:
  // `range`: how many loops further one can touch. `as_one`: a repeat of one loop is solved with its copies.
  LoopTies(long long first, long long last, long long repeat, int border, int range, bool as_one);
  [[nodiscard]] bool is_periodic() const { return is_periodic_; }
  [[nodiscard]] long long last() const { return first_ + count_ - 1; }
  [[nodiscard]] long long reduced_count() const { return reduced_; }
  // The loop of the reduced cloth (counted from 0) that this one moves like.
  [[nodiscard]] long long of(long long loop) const { return of_offset(loop - first_, count_); }
  // The same for a loop of the reduced cloth.
  [[nodiscard]] long long of_reduced(long long offset) const { return of_offset(offset, reduced_); }

 private:
  [[nodiscard]] long long of_offset(long long offset, long long count) const;

  long long first_, count_, reduced_, repeat_;
  int border_;
  bool is_periodic_ = false, tied_ = false;
};

// One repeat of a course that goes on as its own copies, `period` apart; the last point is the first one of
// the next copy.
nurbs::Curve periodic_course(const std::vector<Vec3>& points, const Vec3& period,
                             nurbs::Parameterization how);

// Loops beyond which the influence of an edge is not looked for.
inline constexpr int border_wales = 2;
inline int border_courses(const StitchChart& chart) {
  return chart.longest_hold() + 2;
}

class KnitMoves {
 public:
  // No moves: the loops as published.
  KnitMoves() = default;
  // Moves after which nothing overlaps; how far that came is in mending().
  KnitMoves(const KnitField& field, const KnitYarn& yarn);
  // Do the loops of an endless cloth come apart, each like its copies? Sooner told than how they do. Of a
  // chart that is the whole cloth: its own.
  static bool come_apart(const KnitField& field, const KnitYarn& yarn);

  // Adds to the points of one stitch (add_stitch_points), or to the last one of a course (wale = last + 1).
  void apply(long long course, long long wale, std::vector<Vec3>& points, std::size_t first,
             int end = 0) const;
  // Do all wales move alike, up to the sides of the cloth?
  [[nodiscard]] bool wales_go_on() const { return !ties_.empty() && ties_[1].is_periodic(); }
  // In units of r; z in half thicknesses.
  [[nodiscard]] const Mending& mending() const { return mending_; }
  // Loops that are solved for.
  static long long loops_solved(const KnitField& field);

 private:
  // As its own mirror image, or, where all wales are alike, from a start that is not.
  enum class Start { turned, mirrored };
  void solve(const KnitField& field, const KnitYarn& yarn, int max_steps = MendProblem().max_steps,
             Start start = Start::turned);
  [[nodiscard]] std::size_t loop_index(long long course, long long wale, int end) const;
  // The loop of the reduced cloth whose first point moves like the last point of its course.
  [[nodiscard]] long long end_wale() const;

  std::vector<LoopTies> ties_;            // of courses, of wales
  std::vector<std::size_t> first_class_;  // of each loop of the reduced cloth
  int ends_ = 1;
  Mending mending_;
};

}  // namespace selvage::fabric
