// B-spline basis functions.
#pragma once

#include <array>
#include <vector>

namespace selvage::nurbs {

// Highest degree that is evaluated: readers refuse what is higher. OpenCASCADE, FreeCAD and gmsh have up
// to 25.
inline constexpr int max_degree = 25;

using BasisRow = std::array<double, max_degree + 1>;

// The index k with knots[k] <= t < knots[k + 1], degree <= k < count; the last such span at and beyond the
// end of the domain, the first before it. `count` is the number of control points. Piegl and Tiller A2.1.
int find_span(const std::vector<double>& knots, int degree, int count, double t);

// The degree + 1 basis functions that do not vanish on span k, for control points k - degree .. k. A2.2.
void basis(const std::vector<double>& knots, int degree, int span, double t, BasisRow& values);

// Values and first derivatives.
void basis_slopes(const std::vector<double>& knots, int degree, int span, double t, BasisRow& values,
                  BasisRow& slopes);

// Values, first and second derivatives (rows 0, 1, 2). A2.3.
void basis_derivatives(const std::vector<double>& knots, int degree, int span, double t,
                       std::array<BasisRow, 3>& rows);

// The polar form at `arguments` (`degree` of them) on span k, as factors of the control points k - degree ..
// k: de Boor's triangle run on unit vectors (Ramshaw 1989).
void polar_form(const std::vector<double>& knots, int degree, int span, const double* arguments,
                BasisRow& factors);

// The mean of `degree` neighbouring knots that belongs to each control point: where a linear function has its
// coefficients.
std::vector<double> greville(const std::vector<double>& knots, int degree, int count);

// Gauss-Legendre nodes and weights on [-1, 1], n = 1..10: exact for polynomials of degree 2n - 1.
struct GaussRule {
  std::vector<double> nodes, weights;
};
const GaussRule& gauss_rule(int n);

}  // namespace selvage::nurbs
