// Where faces end: their borders as points, and whether two borders are one curve.
#pragma once

#include <array>
#include <vector>

#include "cad/model.h"

namespace selvage::cad {

// The sides of a surface's range: u = first, u = last, v = first, v = last.
std::array<nurbs::Curve, 4> sides_of(const nurbs::Surface& surface);

// The curve's point at a share of its range: 0 its start, 1 its end.
Vec3 at_share(const nurbs::Curve& curve, double share);
Vec3 at_shares(const nurbs::Surface& surface, double of_u, double of_v);
// The surface's point at the flat curve's.
Vec3 at_share(const nurbs::Surface& surface, const nurbs::Curve& flat, double share);

// Does the whole curve lie in one place? By its control points.
bool is_point(const nurbs::Curve& curve, double tolerance);
// The same of a curve in the parameters, by five of its points: a pole.
bool is_point(const nurbs::Surface& surface, const nurbs::Curve& flat, double tolerance);

// A place of a curve, and how far it is from some point.
struct NearestOnCurve {
  double parameter, distance;
};

// Points of a curve at its knots and between them, with their parameters: enough to find the nearest place.
struct SampledCurve {
  const nurbs::Curve* curve = nullptr;  // outlives this
  std::vector<double> parameters;
  std::vector<Vec3> points;

  explicit SampledCurve(const nurbs::Curve& sampled);
  SampledCurve(const nurbs::Curve& sampled, std::vector<double> at);  // the knots among them
  [[nodiscard]] double length() const;                                // of the polyline through the points
  // The curve's place that is nearest to `p`, or any within `enough` of it. Looks along the nearest chords:
  // the nearest sample need not be next to the nearest place, where a closed curve begins or samples are
  // uneven.
  [[nodiscard]] NearestOnCurve nearest(const Vec3& p, double enough = 0) const;
};

// Where an edge's curves in the parameters and in space are farther apart than this share of the surface's
// size, as files have it, the one in space holds.
inline constexpr double curves_agree = 2e-6;
// Does the edge's curve in parameters hold, to this share of the surface's size? Not where it has none.
bool flat_holds(const nurbs::Surface& surface, const Edge& edge, double agree = curves_agree);

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
