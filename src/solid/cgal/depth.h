// One contact measured on the B-spline surfaces: a gap, or a depth.
#pragma once

#include "solid/cgal/contact.h"
#include "solid/cgal/overlaps.h"

namespace selvage::solid {

struct Measure {
  double depth = 0;  // above 0: the least translation that ends this overlap; else minus the gap
  Vec3 at = Vec3::Zero();
  Vec3 direction = Vec3::Zero();  // as in Overlap
};

// Depths up to this count as touching: rounding, seen from the smaller of both yarns.
double touching(const yarn::Body& a, const yarn::Body& b);

Measure measure(const Skinned& a, const Skinned& b, const Contact& contact);

}  // namespace selvage::solid
