// An explicit control grid as a yarn's surface: the form of the original yarn file (methods.md, 3).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/diagnostics.h"
#include "nurbs/spline.h"
#include "yarn/body.h"

namespace selvage::yarn {

// sections x per_section control points, section after section (per_section fastest).
struct GridNet {
  int sections = 0, per_section = 0;
  std::vector<Vec3> points;
  std::vector<double> weights;  // empty, or one a point
  std::optional<int> degree_along, degree_round;
  std::vector<double> knots_along, knots_round;  // empty: the default
  bool open_round = false;    // the rows are the clamped form: the seam's point stands at both ends
  bool closed_along = false;  // a ring
  std::optional<std::array<double, 4>> corners;  // Body::quarters; none: quarters_of()
};

// The surface of a grid, u round, v along, with the control points that were given untouched.
//   Round: the closed uniform B-spline (degree 2, or degree_round) over each row's polygon, clamped at its
//   seam, knots 0, 1/per_section, .., 1; degree 2: the seam is the midpoint of the edge from the last point
//   to the first. With `open_round` the rows are the clamped form already, first = last point. Along: the
//   clamped cubic (degree sections - 1 for 2 or 3 sections, or degree_along) with knots 0, 1, 2, ..; closed:
//   the periodic one, clamped at its first section's seam.
//   corners: the first u, then values that increase within the range.
//   knots_round needs open_round; with `closed` and knots_along the sections are the clamped form, first =
//   last.
// Fills surface, axis, closed_along and quarters of `body`. Errors (malformed, geometry): impossible counts,
// degrees, knots or corners, an open row whose ends differ.
Status fill_from_grid(Body& body, const GridNet& net);

// The centres of a surface's sections (their mean over u, of the control points alone) as a curve along v.
nurbs::Curve section_centres(const nurbs::Surface& surface);

// Where the corners of the end patches stand that are not told: find_quarters() of the first section, or,
// with fewer than four spans, even parts of the range of u.
std::array<double, 4> quarters_of(const nurbs::Surface& surface);

// The four knots at which an end patch has its corners: the seam, and the three at which the outline has
// turned by nearest to one, two and three quarters (for an ellipse that begins at an axis: the ends of its
// axes). Null with fewer than four spans.
std::optional<std::array<double, 4>> find_quarters(const nurbs::Curve& outline);

}  // namespace selvage::yarn
