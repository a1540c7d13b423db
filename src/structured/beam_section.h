// What a yarn's section is to a beam.
#pragma once

#include <string_view>

#include "core/vec.h"
#include "yarn/body.h"

namespace selvage::fem {

// Constants of a section, in mm, about its principal axes n1 (along its width) and n2 through its centroid.
struct BeamSection {
  // Those that solvers know by name; everything else is general. A circle's or ellipse's, and a rectangle's,
  // second moments follow from width and height to 1 %.
  enum class Shape { circle, ellipse, rectangle, general };
  Shape shape = Shape::general;
  double width = 0, height = 0;  // along n1 and n2
  double area = 0;
  double i11 = 0, i22 = 0;  // integrals of x2^2 and of x1^2; i11 <= i22
  double torsion = 0;       // of Saint-Venant; 0: not computed
};

std::string_view name_of(BeamSection::Shape shape);

// Are two the same to within a share of their area (moments: of twice that)?
bool are_alike(const BeamSection& a, const BeamSection& b, double share);

struct PlacedSection {
  BeamSection section;  // without the torsion constant
  Vec3 centroid = Vec3::Zero();
  Vec3 n1 = Vec3::Zero();  // unit, across the centre line; of a section without axes: toward the seam
};

// Of the B-spline section across the centre line at v; `scale` to mm.
PlacedSection beam_section(const yarn::Body& body, double v, double scale);

// The torsion constant in mm4: twice the integral of Prandtl's stress function, by linear finite elements on
// rays from the centroid (a half per cent too small at most, in ellipses up to ten times as wide as high). Of
// a section whose outline cannot be seen from its centroid: Saint-Venant's estimate A^4 / (4 pi^2 (i11 +
// i22)), exact for ellipses.
double torsion_constant(const yarn::Body& body, double v, double scale);

}  // namespace selvage::fem
