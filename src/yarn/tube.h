// A section swept along a path, as ONE B-spline surface whose distance from the exact swept section is
// bounded.
//
// The exact surface is C(t) + x(u, t) a(t) + y(u, t) b(t): C the centre line, (x, y) the section's outline of
// the size that holds at t, a and b the frame (yarn/frame.h) turned by the section's angle and by twist.
// The outline is replaced by a closed B-spline (yarn/outline.h), and C, a, b (times the size) by cubics. The
// exact surface is one derivative less smooth than the centre line at that line's knots: between two of them
// each cubic has as many equal spans as the tolerance asks for, with exact values and slopes at both ends and
// least squares over samples in between; they meet in double knots. Sections may slide along the path, as far
// as they stay on the surface. The deviation is what samples show, with what can hide between them. Basis
// functions are positive and sum to one, so the deviations of outline and sweep add up to a bound; with them
// comes the half step of the decimal grid to which control points are rounded, so that their texts are short
// and still the same numbers.
#pragma once

#include <cstddef>
#include <vector>

#include "core/decimal_grid.h"
#include "core/diagnostics.h"
#include "yarn/body.h"
#include "yarn/frame.h"
#include "yarn/outline.h"
#include "yarn/path.h"

namespace selvage::yarn {

// Section size and rotation at one path parameter.
struct SizeAtParameter {
  double parameter = 0;
  SectionSize size;
  double angle = 0;  // radians, about the tangent
  bool operator==(const SizeAtParameter&) const = default;
};

// As few of these sizes as give all others within `error` (file units; angles by what they move of the
// section's half size), by the profile through them. Parameters that do not increase are left out.
std::vector<SizeAtParameter> sparse_sizes(const std::vector<SizeAtParameter>& sizes, double error,
                                          bool closed);

struct TubeSpec {
  Section section;
  std::vector<SizeAtParameter> sizes;  // at least one; increasing parameters; monotone cubics between them
  FrameGuide guide;                    // free: from the thickness direction of the first section
  double twist = 0;      // radians per file unit by which the section turns along the path; 0: none
  double tolerance = 0;  // > 0, file units
  DecimalGrid grid;      // of the control points; the end rows of a path that ends obliquely are not on it
  std::size_t max_control_points = 50'000'000;
  bool operator==(const TubeSpec&) const = default;
};

// Fills surface, axis, closed_along, quarters and tube_error of `body` (its name is used in messages;
// warnings go to body.messages). Errors: geometry (a section without size, an `up` along the path, a path
// that turns back), limit (more control points than allowed, which twist or a tight tolerance can ask for).
// The tolerance holds wherever the tube is moved to (yarn/finish.h).
Status sweep(Body& body, const CentreLine& path, const TubeSpec& spec);

}  // namespace selvage::yarn
