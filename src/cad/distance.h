// How far one surface is from others, whatever their knots, degrees, directions and seams.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "core/vec.h"
#include "nurbs/spline.h"

namespace selvage::cad {

// The largest distance of a surface's points from other surfaces: it lies in [at_least, at_most].
struct Reach {
  double at_least = 0, at_most = 0;
  Vec3 at = Vec3::Zero();  // the point of the surface whose distance is `at_least` or more
  // The largest distance at the points that were looked at, each by a search of its own: none of them is
  // farther. Where it is within what was `enough`, at_least is not asked for, and 0.
  double found = 0;
  std::size_t looked_at = 0;
};

// Surfaces that are asked for the points nearest to others. They have to outlive it.
class SurfaceSet {
 public:
  explicit SurfaceSet(const std::vector<const nurbs::Surface*>& surfaces);
  ~SurfaceSet();
  SurfaceSet(SurfaceSet&&) noexcept;
  SurfaceSet& operator=(SurfaceSet&&) noexcept;

  struct Foot {
    std::size_t surface = 0;
    double u = 0, v = 0;
    double distance = 0;
  };
  // A point of the surfaces near to `point`: the nearest one but where that is hidden from a search that
  // begins at the nearest of a grid of points of each surface.
  [[nodiscard]] Foot near(const Vec3& point) const;

  // No point of the surfaces is nearer to `point` than this; within 1 % or 1e-14 of the size below the true
  // distance (less tight where a surface takes more than ten thousand boxes). Boxes of Bezier pieces
  // are divided.
  [[nodiscard]] double least_distance(const Vec3& point, const Foot& foot) const;

  struct Impl;

 private:
  friend class Surveyor;
  std::unique_ptr<const Impl> impl_;
};

// A part of a surface's parameters.
struct Range {
  double u0 = 0, u1 = 1, v0 = 0, v1 = 1;
};
Range domain(const nurbs::Surface& surface);

// The largest distance of the points of `surface` over `range` from `others`.
//
// Cell by cell (first one a pair of knot spans): the feet of four points of a cell tell where it lies in the
// parameters of the others. Where it is a rectangle there, which it is wherever the parameters of both agree
// but for an affine change, a direction, a seam or a cut, the cell is cut at the other's knots, and the
// difference of the two pieces is one polynomial, whose Bernstein coefficients bound it. Elsewhere the
// rectangle is one that a bilinear map takes it to, or the cell's own box bounds it. The worst cells are
// divided, in the direction in which their difference bends, until the bound is at most `enough`, or `near`
// times what was found, or `most_cells` were looked at. `at_most` holds up to the rounding of the arithmetic,
// some 1e-14 of the coordinates' size.
class Region;
struct SurveyOptions {
  std::size_t most_cells = 2000;
  double near = 1.1;
  const Region* region = nullptr;  // of the surface's parameters: what else there is does not count
};
Reach distance_to(const nurbs::Surface& surface, const Range& range, const SurfaceSet& others, double enough,
                  const SurveyOptions& options = {});

// The same by so many points only, without an upper bound.
Reach sampled_distance(const nurbs::Surface& surface, const Range& range, const SurfaceSet& others,
                       double enough, int points, const Region* region = nullptr);

// A curve as a surface of no width: over the curve's parameter in u and [0, 1] in v.
nurbs::Surface as_surface(const nurbs::Curve& curve);

}  // namespace selvage::cad
