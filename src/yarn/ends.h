// What seals a yarn: methods.md, 3, after the paper on IGES output of fabric geometry (../shared/references
// 002).
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include "yarn/body.h"

namespace selvage::yarn {

// A four-sided surface over [0,1]^2 whose boundary curves are the quarters of a closed curve (a bilinearly
// blended Coons patch in B-spline form: the control points are blended at their Greville abscissae). Its
// boundary control points are the quarters' own, to the bit. `quarters` run round one after the other;
// weights are blended with the points.
nurbs::Surface coons_patch(const std::array<nurbs::Curve, 4>& quarters);

// The published end face: the closed curve, two rows on the segments to the centre, and the centre itself.
nurbs::Surface fan(const nurbs::Curve& boundary, const Vec3& centre);

// True where the patch's normal turns over inside (its corners' zero Jacobian aside) against `normal`: the
// control net of a long or concave section can fold.
bool is_folded(const nurbs::Surface& patch, const Vec3& normal);

// The area vector of a closed curve (its length: the enclosed area, for a flat curve; direction: right-hand
// rule).
Vec3 area_vector(const nurbs::Curve& closed);

// The largest distance of the curve's control points from the plane through `origin` across the unit vector
// `normal`.
double flatness(const nurbs::Curve& curve, const Vec3& origin, const Vec3& normal);

// How far from its plane an outline counts as flat: the rounding of its coordinates. `size`: its largest
// distance from a point in it; `largest`: of its coordinates.
inline double flat_enough(double size, double largest) {
  return 1e-9 * std::max(size, largest);
}

// The value of the last decimal digit that any of the coordinates has in its shortest text: 1e-6 for numbers
// that were given to six decimals.
double last_digit(std::span<const Vec3> points);

// What is asked of one end.
struct Sealing {
  EndStyle style = EndStyle::patch;
  std::optional<Vec3> centre;  // where a fan's rows meet; none: the end of the body's axis
  // How well the surface is known: where a plane shall seal an outline that is as flat as this, but not flat
  // enough, its points are moved into the plane.
  double resolution = 0;
  bool operator==(const Sealing&) const = default;
};
using Sealings = std::array<Sealing, 2>;  // of the start and of the end
Sealings both_ends(EndStyle style);

// Fills body.start and body.end from the finished surface. A patch that folds becomes planar where the end is
// flat (with a warning in body.messages; points that are moved into the plane are a note). Rings and `none`
// get no faces. Error (geometry): an end that none of the styles asked for can seal.
Status seal(Body& body, const Sealings& sealings);
Status seal(Body& body, EndStyle style);

// Fills what follows from the body in an end face that was read with its style and surface: origin, normal
// and `inward`. Error (geometry): the section there has no area.
Status complete_end(Body& body, bool last);

// Is the end face, number for number, what seal() makes of this body with this style?
bool is_standard_end(const Body& body, bool last);
// Makes a patch or fan anew, after the body's points were changed.
void renew_end(Body& body, bool last);

}  // namespace selvage::yarn
