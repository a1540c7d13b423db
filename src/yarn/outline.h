// A section's outline as a closed B-spline: how many control points it takes, where they are, how far it is
// from the exact shape.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "core/diagnostics.h"
#include "nurbs/spline.h"
#include "yarn/section.h"

namespace selvage::yarn {

// Width and thickness of a section, file units.
struct SectionSize {
  double width = 0, height = 0;
  bool operator==(const SectionSize&) const = default;
};

// The section's own size (a polygon's: of its box about the origin's axes). Zeros for a circle without
// diameter.
SectionSize nominal_size(const Section& section);

// Each of its lengths changed.
Section with_lengths(const Section& section, const std::function<double(double)>& change);

// Exact enclosed area of the section brought to this size.
double area(const Section& section, const SectionSize& size);

// Errors (geometry): sizes that are not positive and finite, power exponents outside 0.1 .. 10, a polygon of
// fewer than three corners, with equal neighbours, without area, or whose edges cross.
Status check_section(const Section& section, const SectionSize& size);

// A closed, clamped B-spline over [0, 1] that runs counter-clockwise (x across to the right, y up) from the
// section's +x extreme; first point = last point, to the bit.
struct Outline {
  int degree = 2;
  std::vector<double> knots;
  std::vector<Vec2> points;
  std::array<double, 4> quarters{0, 0.25, 0.5, 0.75};  // knots at the section's extremes
};

// In the plane z = 0.
nurbs::Curve as_curve(const Outline& outline);

// The two circular arcs of a lenticular section: their radius, and half of the angle seen from their centres.
struct LensArc {
  double radius, half_angle;
};
LensArc lens_arc(const SectionSize& size);

// Sections of one yarn share their knots. Affine shapes (all but lenticular and racetrack) do so by nature:
// the points of size (W, H) are those of size (2, 2) times W/2 and H/2. The others get knots that suit every
// size when `varying`.
bool is_affine(const Section& section);

// The outline with `pieces` parabolas to a quarter, whose control points are the meeting points of the
// shape's tangents at neighbouring knots; circles and ellipses are uniform periodic cubics of `pieces`
// control points to a quarter, scaled to their exact area (ignored where the outline is exact anyway:
// polygon, loop7).
Outline make_outline(const Section& section, const SectionSize& size, int pieces, bool varying);
bool is_exact(const Section& section);

// Bound on the distance from the outline to the exact shape of that size.
double outline_error(const Section& section, const SectionSize& size, const Outline& outline);

// loop7: (largest radius - smallest radius) / mean radius of the seven-point uniform cubic.
double loop7_out_of_roundness();

}  // namespace selvage::yarn
