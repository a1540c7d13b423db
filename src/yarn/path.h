// The centre line of a yarn, from the rows of a path: one B-spline (rational where it has arcs) over [0, 1],
// and the parameter at which each row's section size holds.
#pragma once

#include <optional>
#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"
#include "nurbs/interpolate.h"
#include "nurbs/spline.h"

namespace selvage::yarn {

enum class PathForm { uniform, chord, centripetal, polyline, control, loop, smooth };

// At an end of the line: its direction there, or the derivative by the parameter over [0, 1] itself.
struct EndTangent {
  Vec3 vector = Vec3::Zero();
  bool is_derivative = false;
  EndTangent() = default;
  EndTangent(const Vec3& given, bool derivative = false) : vector(given), is_derivative(derivative) {}
  friend bool operator==(const EndTangent& a, const EndTangent& b) = default;
};

struct PathRows {
  PathForm form = PathForm::chord;
  std::vector<Vec3> points;
  bool closed = false;  // the first point follows the last
  std::optional<EndTangent> tangent_start, tangent_end;
  // polyline: half the section's size in the plane of the bend at row i; corners are rounded by an arc
  // of 1.05 times it.
  std::vector<double> half_sizes;
  // control: rows + 4 knots, clamped (closed: of the clamped form, whose last row is its first); empty:
  // uniform.
  std::vector<double> knots;
  double error = 0;  // smooth: > 0, how far a row may be from the line
};

struct CentreLine {
  nurbs::Curve curve;  // over [0, 1], C1; closed: the first point equals the last, to the bit
  bool closed = false;
  std::vector<double> parameters;  // one a row: where it is met, comes nearest (loop, smooth), or has its
                                   // largest share (control)
  double largest_miss =
      0;  // loop, smooth: the largest distance of the curve from a row's point; 0 for the others
  bool operator==(const CentreLine&) const = default;
};

// uniform, chord, centripetal: the cubic through the rows (nurbs/interpolate.h). control: the rows are
// control points of the clamped uniform cubic (degree rows - 1 below four rows; closed: the periodic one).
// smooth: the least squares cubic within the error of the rows (nurbs/smooth.h), through them (chord) where
// they are too few for that. loop: ../shared/references 000. polyline: segments and arcs, exact as a rational
// quadratic. Errors (geometry): equal neighbouring points, a closed path of fewer than three points, polyline
// corners with no room for their arc or that turn back by more than 150 degrees; the message's place.line
// holds the index (from 1) of the row concerned.
Result<CentreLine> make_centre_line(const PathRows& rows);

// The control points of a loop path: two for every row, on the line through it parallel to the chord of its
// neighbours; the ends of an open path are rows themselves. At least two rows; neighbours of a row differ.
std::vector<Vec3> loop_control_points(const std::vector<Vec3>& rows, bool closed);

}  // namespace selvage::yarn
