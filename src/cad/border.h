// Where faces end: their borders as points, and whether two borders are one curve.
#pragma once

#include <vector>

#include "cad/model.h"

namespace selvage::cad {

// Points of a curve at its knots and between them, with their parameters: enough to find the nearest place.
struct SampledCurve {
  const nurbs::Curve* curve = nullptr;  // outlives this
  std::vector<double> parameters;
  std::vector<Vec3> points;

  explicit SampledCurve(const nurbs::Curve& sampled);
  [[nodiscard]] double length() const;  // of the polyline through the points
  // The parameter of the curve's point that is nearest to `p`, and how far that is.
  struct Nearest {
    double parameter, distance;
  };
  [[nodiscard]] Nearest nearest(const Vec3& p) const;
};

// How far points may be apart that are meant to be one: the file's resolution, within 1e-6 and 1e-4 of the
// size of what they belong to (and above the rounding of their coordinates).
double closeness(double size, double largest_coordinate, double resolution);

// The border of a face with at most one loop, as polylines of points that lie on it exactly; seams and edges
// without length are left out. Nothing where there are holes or no border.
using Polylines = std::vector<std::vector<Vec3>>;
Polylines border_of(const Face& face, double tolerance);

// Is this border the closed curve, all of it? Distances up to the tolerance.
bool runs_along(const Polylines& border, const SampledCurve& closed, double tolerance);

// The largest distance of points with the same index; equally many of both.
double largest_difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b);

}  // namespace selvage::cad
