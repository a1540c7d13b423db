// B-spline curves and surfaces: the shape in which every yarn lives, from the text to the files.
#pragma once

#include <cstddef>
#include <vector>

#include "core/vec.h"

namespace selvage::nurbs {

// A B-spline curve. knots.size() == points.size() + degree + 1, not decreasing; the curve lives on
// [knots[degree], knots[points.size()]]. Clamped unless said otherwise. Weights: empty for a polynomial
// curve, else one positive weight a point (points are NOT multiplied by them).
struct Curve {
  int degree = 3;
  std::vector<double> knots;
  std::vector<Vec3> points;
  std::vector<double> weights;

  [[nodiscard]] bool is_rational() const { return !weights.empty(); }
  [[nodiscard]] double weight(std::size_t i) const { return weights.empty() ? 1.0 : weights[i]; }
  [[nodiscard]] double first_parameter() const { return knots[static_cast<std::size_t>(degree)]; }
  [[nodiscard]] double last_parameter() const { return knots[points.size()]; }

  bool operator==(const Curve&) const = default;
};

// A tensor-product B-spline surface of count_u x count_v control points; u runs fastest: the point (i, j) is
// points[j * count_u + i]. Each direction obeys the rules of Curve. For a yarn, u runs round the section and
// v along the path.
struct Surface {
  int degree_u = 2;
  int degree_v = 3;
  int count_u = 0;
  int count_v = 0;
  std::vector<double> knots_u;
  std::vector<double> knots_v;
  std::vector<Vec3> points;
  std::vector<double> weights;

  [[nodiscard]] bool is_rational() const { return !weights.empty(); }
  [[nodiscard]] bool is_empty() const { return points.empty(); }
  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(count_u) + static_cast<std::size_t>(i);
  }
  [[nodiscard]] const Vec3& point(int i, int j) const { return points[index(i, j)]; }
  [[nodiscard]] Vec3& point(int i, int j) { return points[index(i, j)]; }
  [[nodiscard]] double weight(int i, int j) const { return weights.empty() ? 1.0 : weights[index(i, j)]; }
  [[nodiscard]] double first_u() const { return knots_u[static_cast<std::size_t>(degree_u)]; }
  [[nodiscard]] double last_u() const { return knots_u[static_cast<std::size_t>(count_u)]; }
  [[nodiscard]] double first_v() const { return knots_v[static_cast<std::size_t>(degree_v)]; }
  [[nodiscard]] double last_v() const { return knots_v[static_cast<std::size_t>(count_v)]; }

  bool operator==(const Surface&) const = default;
};

// Position and derivatives at one parameter. d1, d2: first and second derivative.
struct CurveJet {
  Vec3 position, d1, d2;
};
struct SurfaceJet {
  Vec3 position, du, dv;
};

// Evaluation inside the domain (parameters outside are brought to its nearest end). Piegl and Tiller, The
// NURBS Book, A2.1-A2.3 and A4.2, A4.4.
Vec3 evaluate(const Curve& curve, double t);
CurveJet evaluate_jet(const Curve& curve, double t);
Vec3 evaluate(const Surface& surface, double u, double v);
SurfaceJet evaluate_jet(const Surface& surface, double u, double v);

// The surface at every (u, v) of a grid, u fastest: us.size() x vs.size() points. Much faster than one by
// one.
std::vector<Vec3> evaluate_grid(const Surface& surface, const std::vector<double>& us,
                                const std::vector<double>& vs);

// Straight and even, from one place at t0 to another at t1.
Curve segment(const Vec3& from, const Vec3& to, double t0 = 0, double t1 = 1);

// The curve of constant v: its control points are those of the surface's columns at v.
Curve row_at(const Surface& surface, double v);

// Column i of the control points over v; the surface that has these columns, all over the same knots.
Curve control_column(const Surface& surface, int i);
Surface of_columns(int degree_u, const std::vector<double>& knots_u, const std::vector<Curve>& columns);

// The first or last control row (column) of a surface clamped there: exactly its boundary curve.
Curve boundary_row(const Surface& surface, bool last);
Curve boundary_column(const Surface& surface, bool last);
// The four of them one after the other, counter-clockwise in (u, v) from (first u, first v).
std::array<Curve, 4> boundary_round(const Surface& surface);

// The different knot values inside the domain, ends included, increasing.
std::vector<double> breakpoints(const std::vector<double>& knots, int degree);

// The same curve with the value t inserted `times` times more (Boehm). Precondition: first <= t <= last
// parameter, and the multiplicity afterwards does not pass the degree.
Curve insert_knot(const Curve& curve, double t, int times = 1);

// How often a knot stands there.
int multiplicity(const std::vector<double>& knots, double t);

// The same curve with the knot t as often as its degree at least: it passes through a control point there.
Curve opened_at(const Curve& curve, double t);

// The part of a curve, clamped or not, between two parameters, with the end knots clamped there; t0 < t1.
// Knot values keep their numbers (no reparameterization).
Curve sub_curve(const Curve& curve, double t0, double t1);

// The same curve run backwards; the knots become (first + last) - knot.
Curve reversed(const Curve& curve);
std::vector<double> reversed_knots(const std::vector<double>& knots);

using Vec4 = Eigen::Vector4d;

// (w p, w): a control point as blends take it.
inline Vec4 homogeneous(const Vec3& point, double weight) {
  return {point.x() * weight, point.y() * weight, point.z() * weight, weight};
}
inline Vec4 homogeneous(const Curve& curve, std::size_t i) {
  return homogeneous(curve.points[i], curve.weight(i));
}

}  // namespace selvage::nurbs
