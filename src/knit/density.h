// Loops of a given length in a weft knit of given densities.
//
// Spacings spread the published loop (loop.h); what then is free gives it its length: first feet and
// shoulders move away from the middle of their leg and heads and sinkers reach farther, both together, as far
// as yarns pass each other; loops longer than that stand out of the cloth. The length grows all along that
// way, so that each length from its least to its largest is met once.
#pragma once

#include "core/diagnostics.h"
#include "knit/loop.h"
#include "nurbs/interpolate.h"

namespace selvage::fabric {

// The yarn that a stitch takes (knitted or tucked; misses take none of their own), the mean over a repeat of
// the chart in an endless cloth, as published. half: of the section, across and through the thickness; file
// units, as the length.
double stitch_length(const KnitField& field, nurbs::Parameterization how, const Vec2& half);

// The least and the largest that the field's spacings allow.
struct LengthBounds {
  double least = 0, most = 0;
};
LengthBounds length_bounds(const KnitField& field, nurbs::Parameterization how, const Vec2& half);

// The field's shape with stitches of this length (to 1e-9 of it). Error (geometry): shorter or longer than
// what there is, with the bounds, and what would make it fit.
Result<LoopShape> shape_of_length(const KnitField& field, nurbs::Parameterization how, const Vec2& half,
                                  double length);

}  // namespace selvage::fabric
