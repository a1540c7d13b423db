// Splines given by polynomials in the power basis, a cubic a + b s + c s^2 + d s^3 a piece, s from the
// piece's own start: exactly as B-splines.
#pragma once

#include <array>
#include <vector>

#include "nurbs/spline.h"

namespace selvage::nurbs {

using Cubic = std::array<Vec3, 4>;  // a, b, c, d

// breaks.size() == pieces.size() + 1, increasing. What a piece ends with is taken from the next one's start;
// `gap`: the largest distance between the two. Degree 3, knots at the breaks, three times each.
Curve from_power(const std::vector<double>& breaks, const std::vector<Cubic>& pieces, double* gap = nullptr);

// Patches over breaks_u x breaks_v, u fastest; [k][l] is the coefficient of s^k t^l.
using Bicubic = std::array<std::array<Vec3, 4>, 4>;
Surface from_power(const std::vector<double>& breaks_u, const std::vector<double>& breaks_v,
                   const std::vector<Bicubic>& patches, double* gap = nullptr);

}  // namespace selvage::nurbs
