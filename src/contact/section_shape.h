// Measures of one section of a yarn: the closed curve of its surface at one parameter along the path.
#pragma once

#include <vector>

#include "nurbs/spline.h"

namespace selvage::contact {

struct SectionShape {
  double area = 0;  // of the curve's area vector: the flat section's area
  // The least turning of the outline between neighbouring samples (four a span round), radians, seen along
  // the area vector: below zero the section is not convex there.
  double least_turning = 0;
};

// Below minus this a section counts as concave: what sampling and rounding leave of straight sides.
inline constexpr double turning_noise = 1e-5;

// Sections at the parameters `vs`.
std::vector<SectionShape> section_shapes(const nurbs::Surface& surface, const std::vector<double>& vs);

}  // namespace selvage::contact
