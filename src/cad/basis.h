// Surfaces over the same basis (degrees, counts, and knots up to an affine change), whichever way their
// parameters run: they are compared by their control points.
#pragma once

#include <cstddef>
#include <optional>

#include "core/vec.h"
#include "nurbs/spline.h"

namespace selvage::cad {

// Which control point of b stands for (i, j) of a.
struct Alignment {
  bool swapped = false;                         // a's u is b's v
  bool backward_u = false, backward_v = false;  // of a's directions

  [[nodiscard]] std::size_t index_in(const nurbs::Surface& b, int i, int j) const;
};

struct ControlChange {
  Alignment alignment;
  bool fits_as_it_is = false;  // the bases agree without turning anything
  double largest = 0;          // distance of two control points that belong together
  int i = 0, j = 0;            // of that point in a, from 0
  std::size_t changed = 0;     // points that are more than the tolerance apart
  // No point of a is farther from b than this, nor the other way round: `largest` by the convex hull
  // property, and more where knots or weights differ. Of the knots' part the first order (a knot's share in a
  // spline's change is at most its largest derivative's coefficient times its own change).
  double bound = 0;
};

// Of the eight ways to lay b's parameters along a's, the one with the least `bound`; none where the bases
// differ. Knots agree within 1e-6 of the domain. It stops at the first way whose bound is within the
// tolerance.
std::optional<ControlChange> compare_control_points(const nurbs::Surface& a, const nurbs::Surface& b,
                                                    double tolerance);

// Whether there is such a way.
bool have_one_basis(const nurbs::Surface& a, const nurbs::Surface& b);

}  // namespace selvage::cad
