// The same surface with other parameters, and its clamped form.
#pragma once

#include "nurbs/chain.h"  // transposed()
#include "nurbs/spline.h"

namespace selvage::nurbs {

// u (v) runs backwards: the normal turns over. Control points and weights keep their bits, a knot becomes
// (first + last) - knot.
Surface reversed_u(const Surface& surface);
Surface reversed_v(const Surface& surface);

bool is_clamped(const std::vector<double>& knots, int degree);

// The clamped form of a surface whose end knots are not repeated, in both directions; one that is clamped
// keeps all its bits.
Surface clamped(const Surface& surface);

}  // namespace selvage::nurbs
