// The data points of a warp knit's yarns: the dimensions of its loops, and how they follow each other.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"
#include "core/wrapped.h"
#include "fabric/model.h"
#include "knit/lapping.h"

namespace selvage::fabric {

// How much further the foot before a loop reaches down than the one after it, in yarns lying across.
constexpr double low_foot = 0.4;
// Most data points of a course: a loop of eleven, four through a substrate, an underlap of two.
constexpr int points_of_a_course = 17;

struct Bar {
  Lapping lapping;
  const Thread* thread = nullptr;
  bool is_fall_plate = false;
  TextPlace place;
  bool has_feet = false;                 // wraps needles in some course
  int bars_behind = 0;                   // of all bars
  int feet_before = 0, feet_behind = 0;  // bars with feet before and behind this one
  double thickness = 0;                  // of its yarns, file units
  const OwnLoop* own = nullptr;          // the user's; null: of the measures
};

// The dimensions of the loops, file units. They grow with the pitches, so that the smallest pitches are those
// at which neighbours touch: x in units of a foot's width, y in units of a yarn lying across, z in layers of
// one yarn.
struct Measures {
  double wale_pitch = 0, course_pitch = 0;
  double across = 0, along = 0, layer = 0;
  int bars_with_feet = 0;
  int fall_plates = 0;
  bool has_weft = false;    // straight yarns between loops and underlaps
  double thickest = 0;      // of all yarns, file units
  double deepest_foot = 0;  // below and above a course's line
  double substrate = 0;     // between underlaps and heads

  [[nodiscard]] double foot_x(const Bar& bar) const { return (0.5 + bar.feet_behind) * across; }
  [[nodiscard]] double leg_x() const { return (0.5 + bars_with_feet) * across; }
  // Underlaps reach a course's line from below, at -reach_y, and leave it at foot_y.
  [[nodiscard]] double reach_y(const Bar& bar) const {
    // A fall-plate bar's below all feet that its arch takes in; a loop's out of the way of its own underlap.
    return bar.is_fall_plate ? deepest_foot + along : foot_y(bar) + low_foot * along;
  }
  [[nodiscard]] double foot_y(const Bar& bar) const { return (0.5 + bar.feet_before) * along; }
  [[nodiscard]] double head_y() const { return deepest_foot + (2.0 + fall_plates) * along; }
  [[nodiscard]] double arch_y(const Bar& bar) const { return deepest_foot + (1.2 + bar.feet_before) * along; }
  [[nodiscard]] double underlap_z(const Bar& bar) const {
    return -(1.0 + (fall_plates > 0 || has_weft ? 1.0 : 0.0) + bar.bars_behind) * layer - substrate;
  }
  [[nodiscard]] double arch_z() const { return -layer; }
  // A straight weft lies above the heads that stand on a course's line, below the feet of the next course.
  [[nodiscard]] double weft_y() const {
    const double reach = deepest_foot + (fall_plates > 0 ? 1.0 : low_foot) * along;
    return 0.5 * (head_y() + course_pitch - reach);
  }
  [[nodiscard]] double weft_z() const { return -layer; }
  [[nodiscard]] double head_z(const Bar& bar) const { return bar.feet_behind * layer; }
  [[nodiscard]] double leg_z(const Bar& bar) const { return (bars_with_feet + bar.feet_behind) * layer; }
};

// Moves of data points away from where Measures has them, for every bar and every course of a repeat alike.
class LoopMoves {
 public:
  // Which move: those of a course of the repeat, or of the two ends of the yarns of a bar.
  static constexpr std::size_t most_points = 20;  // of a course
  LoopMoves() = default;
  LoopMoves(std::size_t bars, long long repeat)
      : repeat_(repeat), moves_(bars * static_cast<std::size_t>(repeat + 2) * most_points, Vec3::Zero()) {}

  // Numbers of moves: point k of a course, of the beginning, and of the end.
  [[nodiscard]] std::size_t of_course(std::size_t bar, long long course, std::size_t k) const {
    return at(bar, wrapped(course, repeat_), k);
  }
  [[nodiscard]] std::size_t of_beginning(std::size_t bar, std::size_t k) const { return at(bar, repeat_, k); }
  [[nodiscard]] std::size_t of_end(std::size_t bar, std::size_t k) const { return at(bar, repeat_ + 1, k); }
  [[nodiscard]] std::size_t count() const { return moves_.size(); }
  // None moves where there is no repeat.
  [[nodiscard]] Vec3 operator[](std::size_t number) const {
    return moves_.empty() ? Vec3(Vec3::Zero()) : moves_[number];
  }
  void set(std::size_t number, const Vec3& move) { moves_[number] = move; }

 private:
  [[nodiscard]] std::size_t at(std::size_t bar, long long slot, std::size_t k) const {
    return (bar * static_cast<std::size_t>(repeat_ + 2) + static_cast<std::size_t>(slot)) * most_points + k;
  }

  long long repeat_ = 1;
  std::vector<Vec3> moves_;
};

// The data points of one yarn, course by course: those of the bar's first guide. Everything outlives it.
class YarnPoints {
 public:
  YarnPoints(const Bar& bar, std::size_t bar_number, const Measures& measures, const LoopMoves& moves)
      : bar_(bar), bar_number_(bar_number), m_(measures), moves_(moves) {}

  // From below the first course straight to its foot.
  void begin(long long course, const Overlap& overlap);
  // From the foot that an underlap has reached, or past the needle, to the foot from which the next begins. A
  // loop is held for `hold` courses.
  void overlap(long long course, const Overlap& overlap, int hold);
  // Two points within a long underlap from one overlap to that of the next course: near its ends it is a
  // straight line already.
  void underlap(long long course, const Overlap& before, const Overlap& after);
  // The foot of the course after the last, and straight up from it.
  void finish(long long course, const Overlap& overlap);

  [[nodiscard]] std::vector<Vec3> of_guide(std::size_t guide) const;
  // For each point, which of the moves moves it.
  [[nodiscard]] const std::vector<std::size_t>& moved_by() const { return moved_by_; }
  // For each course, the first and the last of its points from foot to foot.
  [[nodiscard]] const std::vector<std::array<std::size_t, 2>>& stitches() const { return stitches_; }

 private:
  [[nodiscard]] Vec3 point(long long course, const Overlap& overlap, const Vec3& local,
                           const Vec3& move) const;
  void put(long long course, const Overlap& overlap, double x, double y, double z);
  void put_moved(long long course, const Overlap& overlap, const Vec3& local, std::size_t number);
  [[nodiscard]] std::size_t next_number(long long course) {
    return moves_.of_course(bar_number_, course, placed_++);
  }
  [[nodiscard]] Vec3 own_point(const Vec3& p) const;
  [[nodiscard]] Vec3 foot_in(const Overlap& overlap) const;
  [[nodiscard]] Vec3 foot_out(const Overlap& overlap) const;
  [[nodiscard]] double foot_x(const Overlap& overlap) const {
    return overlap.is_laid_in() ? 0.0 : m_.foot_x(bar_);
  }
  void arch(long long course, const Overlap& overlap, const std::vector<Vec3>& flank, const Vec3& top);
  void loop(long long course, const Overlap& overlap, int hold);
  void low_arch(long long course, const Overlap& overlap);

  const Bar& bar_;
  std::size_t bar_number_;
  const Measures& m_;
  const LoopMoves& moves_;
  std::size_t placed_ = 0;  // points of this course
  std::vector<Vec3> points_;
  std::vector<std::size_t> moved_by_;
  std::vector<std::array<std::size_t, 2>> stitches_;
};

// A loop is held while its needle waits for the next one; a machine breaks the yarn sooner than after these
// courses.
inline constexpr int longest_hold = 8;

// Courses until the needles get their next loops; 0: longer than a loop is held.
int hold_after(const std::vector<Bar>& bars, long long course);

// The yarn of a bar's first guide, over the courses from `first` to the one before `last`. Error (geometry):
// a loop that would be held too long.
Result<YarnPoints> points_of_bar(const std::vector<Bar>& bars, std::size_t bar, const Measures& measures,
                                 const LoopMoves& moves, long long first, long long last);

}  // namespace selvage::fabric
