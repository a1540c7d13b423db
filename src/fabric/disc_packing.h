// Equal discs in a circle, or in any other section: where the parts of a yarn lie.
//
// Up to 30 discs are arranged by pushing them apart from rings and pieces of the hexagonal lattice, always
// from the same starts, so that the same number gives the same bits; the radii come within 0.5 % (mostly 0.01
// %) of the best ones known (Graham, Lubachevsky, Nurmela, Oestergard: Dense packings of congruent circles in
// a circle, Discrete Mathematics 181, 1998). More are a piece of the hexagonal lattice, about the best of its
// centres of symmetry.
#pragma once

#include <cstddef>
#include <vector>

#include "core/vec.h"

namespace selvage::fabric {

struct DiscPacking {
  double radius = 1;  // of the discs
  std::vector<Vec2> centres;
};

// n >= 1 discs in the circle of radius 1 about the origin. None overlap: the radius is measured on the
// centres.
DiscPacking discs_in_circle(std::size_t n);

// n >= 1 discs on a hexagonal lattice inside a polygon that holds the origin. Radius 0 where no place was
// found.
DiscPacking discs_in_polygon(std::size_t n, const std::vector<Vec2>& polygon);

}  // namespace selvage::fabric
