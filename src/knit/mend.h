// Centre lines are moved apart on the level of their data points: how the loops of a construction come out
// free of overlap.
//
// Unknown is one move a class of data points; points of one class move alike, so that a periodic cloth stays
// periodic, whatever its size, and is solved on a piece of it. The moves minimise
//   1/2 sum |d|^2 + bending and stretching of d along each line + penalties
// where the penalties ask for a distance of two places on the lines of at least the sum of what the yarns
// reach out there, and for bends that are no tighter than a yarn can take. Sums over the cells of a fine
// division of all lines, the nearest place of a cell found by Newton's method; minimised by the Gauss-Newton
// method with steps that do not jump over a yarn, so that the interlacing stays what it was. Where the
// penalties leave something missing (or a line that keeps its length longer or shorter), more is asked for,
// until it is there.
//
// The result is a function of the input alone: one thread, no clock.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "core/vec.h"
#include "nurbs/spline.h"

namespace selvage::fabric {

// What a data point contributes to a control point.
struct Share {
  std::size_t point = 0;
  double weight = 0;
};

struct MendLine {
  std::vector<Vec3> points;  // data points, at least two
  std::vector<int> classes;  // of each data point; -1: it does not move
  // Not zero: the line goes on at both ends as its own copies, each shifted by this. Its last data point is
  // the first one of the next copy, of the same class.
  Vec3 period = Vec3::Zero();
  // The centre line through (or near) data points: a polynomial cubic, C1 or smoother. Called with points
  // that are moved; deterministic.
  std::function<nurbs::Curve(const std::vector<Vec3>&)> curve;
  // Its control points as sums of data points, one list a control point, with all lengths and parameters held
  // at their present values (a constant part, of directions given at ends, is left out). Shares below 1e-3
  // may be left out as well.
  std::function<std::vector<std::vector<Share>>(const std::vector<Vec3>&)> shares;
  // MendProblem::repeat holds for it, too.
  bool repeats = true;
  // Its length stays what it is at the given points (see MendProblem::measure).
  bool keeps_length = false;
  double radius = 1;  // of the yarn, about: the scale of steps and searches
  // How far the yarn reaches from its centre line in a direction (unit), half of the wanted gap included.
  // Empty: `radius`.
  std::function<double(const Vec3& tangent, const Vec3& direction)> reach;
};

struct MendProblem {
  std::vector<MendLine> lines;
  // One a class: 1 for a coordinate that is free, 0 for one that is held.
  std::vector<Vec3> freedom;
  // Where the lines are their own mirror image in a plane x = const: the class that each is the image of, one
  // a class. The moves then keep to it. Else empty.
  std::vector<int> images;
  // Moves to begin with where any are needed, one a class; empty: none.
  std::vector<Vec3> start;
  // Not zero: the lines stand again at all multiples of this, and their copies move like them.
  Vec3 repeat = Vec3::Zero();
  // True lengths are those of all points times this.
  Vec3 measure = Vec3::Ones();
  // Two places of one line count when they are farther apart along it than this, in radii.
  double apart = 3;
  // Bends tighter than this, in radii, are opened to about it.
  double bend = 1.15;
  int max_steps = 80;
  // Once they are apart, the lines take the shape of least bending energy (the integral of the squared
  // curvature by arc length, of true lengths) that the room has; small moves are no end in themselves then.
  bool relaxes = false;
};

struct Mending {
  std::vector<Vec3> moves;  // one a class
  double missing = 0;       // the largest lack of distance that is left; 0: every pair has what it needs
  Vec3 at = Vec3::Zero();   // where most is missing

  // Bending energies before and after, of true lengths; only where lines relax.
  double bent_before = 0, bent = 0;
  bool is_relaxed = false;
  double stretch = 0;  // the largest that is left of a line that keeps its length, a share of it

  [[nodiscard]] bool is_solved() const { return missing == 0; }
};

Mending mend(const MendProblem& problem);

// The shares of the clamped cubic through data at these parameters (nurbs/interpolate.h), its derivatives at
// the ends held.
inline constexpr double least_share = 1e-3, least_relaxed_share = 1e-9;  // smaller ones are left out
std::vector<std::vector<Share>> interpolation_shares(const std::vector<double>& parameters,
                                                     double least = least_share);
// The same for the periodic cubic; the last parameter is that of the return to the first data point.
std::vector<std::vector<Share>> periodic_shares(const std::vector<double>& parameters,
                                                double least = least_share);

}  // namespace selvage::fabric
