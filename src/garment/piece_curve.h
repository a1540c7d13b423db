// The B-splines of a piece's outline, and their edits.
#pragma once

#include <vector>

#include "core/diagnostics.h"
#include "fabric/model.h"
#include "nurbs/spline.h"

namespace selvage::fabric {

// A curve `control` or `spline` over [0, 1] in z = 0, of degree 3, through or by these points (its own,
// joined to its neighbours). control: the clamped cubic over uniform knots, or its own; rational by its
// weights. spline: the clamped cubic through the points with the end derivatives of parabolas (methods.md,
// 1); with weights the rational one whose weight at each point is that of the point: (w p, w) is
// interpolated. Error (geometry): weights so uneven that one of the curve's own is not above 0.
Result<nurbs::Curve> spline_of(const PieceCurve& source, const std::vector<Vec2>& points);

// The curve after an edit of an inner joint, to `length` where the edit is one by length. Errors (geometry):
// as nurbs/edit.h; an end, where the outline would open.
Result<nurbs::Curve> edited(const nurbs::Curve& curve, const Edit& edit, double length);

}  // namespace selvage::fabric
