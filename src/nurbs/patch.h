// Parts of B-spline surfaces in Bezier form: bounds and samples.
#pragma once

#include <vector>

#include "core/vec.h"
#include "nurbs/spline.h"

namespace selvage::nurbs {

// Control points of a part of a surface within one knot span of either direction, u fastest. The part lies in
// their convex hull.
struct Patch {
  int count_u = 0, count_v = 0;
  std::vector<Vec3> points;
  std::vector<double> weights;  // empty: polynomial

  [[nodiscard]] const Vec3& point(int i, int j) const {
    return points[static_cast<std::size_t>(j) * static_cast<std::size_t>(count_u) +
                  static_cast<std::size_t>(i)];
  }
};

// The surface between two parameters of either direction that lie in one knot span (Ramshaw 1989: control
// points are values of the polar form).
Patch patch_of(const Surface& surface, const Vec2& low, const Vec2& high);

// One half of the patch along an axis (0: u, 1: v), by de Casteljau's scheme.
Patch half_of(const Patch& patch, int axis, bool upper);

// (cells_u + 1) x (cells_v + 1) points at even steps of the patch's own parameters, u fastest.
void sample(const Patch& patch, int cells_u, int cells_v, std::vector<Vec3>& out);

// Grows the box until it holds the surface, but for what stands out by `tolerance` (> 0) or less: patches
// that reach beyond it are halved until that is known.
void extend(Box3& box, const Surface& surface, double tolerance);

// Unit, by the patch's diagonals; outward when `inward` says how S_u x S_v runs; zero where it has none.
Vec3 middle_normal(const Patch& patch, bool inward);

// The least of p . direction over the control points; the greatest.
double lowest(const Patch& patch, const Vec3& direction);
double highest(const Patch& patch, const Vec3& direction);

// A lower bound of the distance of two patches: the widest empty slab between the hulls over a few
// directions. Negative: -(the least overlap of their extents) over these directions.
double slab_gap(const Patch& a, const Vec3& normal_a, const Patch& b, const Vec3& normal_b);

}  // namespace selvage::nurbs
