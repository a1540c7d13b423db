// Pieces of surfaces as polynomials in Bernstein form: what their coefficients bound.
#pragma once

#include <array>

#include "core/vec.h"
#include "nurbs/spline.h"

namespace selvage::cad {

struct Range;

// A bilinear map of [0, 1]^2 into the parameters of a surface: u = of[0], v = of[1], each
// c0 + c1 s + c2 t + c3 s t.
struct BilinearMap {
  std::array<std::array<double, 4>, 2> of{};

  // Where u depends on s only and v on t only (or the other way round: swapped) but for shares up to `near`,
  // makes it exactly so. False: it is no such rectangle.
  bool make_rectangle(double near);
  // Of a rectangle:
  [[nodiscard]] bool is_swapped() const;
  // Start and slope of u (or v) along the side that it depends on.
  [[nodiscard]] std::array<double, 2> line(bool of_u) const;
  // The image of a part of [0, 1]^2. u0 > u1 where it runs backwards.
  [[nodiscard]] Range rectangle(double s0, double s1, double t0, double t1) const;
};

// A box round the part of the surface over `range`, which lies between two neighbouring knots in each
// direction; empty where none can be told.
Box3 piece_bounds(const nurbs::Surface& surface, const Range& range);

// How far two pieces are apart where they are laid upon each other.
struct PieceDifference {
  double bound = 0;               // on |a(s, t) - b(s, t)| over [0, 1]^2; infinite where none can be told
  double bend_s = 0, bend_t = 0;  // how much the difference bends along s and t: dividing that way helps
};
// a and b run through their ranges (each between neighbouring knots; u0 > u1: backwards); `swapped`: b's u
// runs with t.
PieceDifference piece_difference(const nurbs::Surface& a, const Range& range_a, const nurbs::Surface& b,
                                 const Range& range_b, bool swapped);

// A function of space whose zeros are a surface: a polynomial of `degree`.
class Implicit {
 public:
  virtual ~Implicit() = default;
  [[nodiscard]] virtual int degree() const = 0;
  [[nodiscard]] virtual double value(const Vec3& p) const = 0;
  [[nodiscard]] virtual Vec3 gradient(const Vec3& p) const = 0;
};
struct ImplicitBounds {
  double largest_value, least_gradient;  // of the absolute values; infinite and 0 where none can be told
};
// Of `function` over a piece of a surface, which lies between neighbouring knots.
ImplicitBounds implicit_bounds(const nurbs::Surface& surface, const Range& range, const Implicit& function);

}  // namespace selvage::cad
