#include "yarn/congruence.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/bounds.h"
#include "yarn/rigid_fit.h"

namespace selvage::yarn {

namespace {

using nurbs::Surface;

constexpr double infinity = std::numeric_limits<double>::infinity();

bool are_of_one_form(const Surface& a, const Surface& b) {
  return a.degree_u == b.degree_u && a.degree_v == b.degree_v && a.count_u == b.count_u &&
         a.count_v == b.count_v && a.is_rational() == b.is_rational();
}

// The largest difference of two lists of the same length.
double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

// A bound on the speed of the lines of constant u (along) or v.
double largest_speed(const Surface& s, bool along) {
  const int degree = along ? s.degree_v : s.degree_u;
  const std::vector<double>& knots = along ? s.knots_v : s.knots_u;
  const int lines = along ? s.count_u : s.count_v, count = along ? s.count_v : s.count_u;
  double speed = 0;
  for (int k = 0; k + 1 < count; ++k) {
    const double span =
        knots[static_cast<std::size_t>(k + degree + 1)] - knots[static_cast<std::size_t>(k + 1)];
    if (!(span > 0)) continue;
    for (int line = 0; line < lines; ++line) {
      const Vec3& p = along ? s.point(line, k) : s.point(k, line);
      const Vec3& q = along ? s.point(line, k + 1) : s.point(k + 1, line);
      speed = std::max(speed, degree * (q - p).norm() / span);
    }
  }
  return speed;
}

// How far equal control points on unequal knots and weights may lie apart: each of the 2 p knots that a point
// depends on moves it by no more than the speed times its own shift.
double basis_deviation(const Surface& a, const Surface& b) {
  double deviation = 0;
  for (const bool along : {false, true}) {
    const double shift = along ? difference(a.knots_v, b.knots_v) : difference(a.knots_u, b.knots_u);
    if (shift > 0) deviation += 2 * (along ? a.degree_v : a.degree_u) * largest_speed(a, along) * shift;
  }
  double change = 0;
  for (std::size_t k = 0; k < a.weights.size(); ++k)
    change = std::max(change, std::abs(a.weights[k] / b.weights[k] - 1));
  if (change > 0) deviation += 2 * change * bounds_of(a.points).diagonal().norm();
  return deviation;
}

bool have_one_form(const Body& a, const Body& b) {
  if (a.closed_along != b.closed_along || a.inward != b.inward || !are_of_one_form(a.surface, b.surface))
    return false;
  const auto ends_alike = [](const EndFace& x, const EndFace& y) {
    return x.style == y.style && x.inward == y.inward && are_of_one_form(x.surface, y.surface);
  };
  return ends_alike(a.start, b.start) && ends_alike(a.end, b.end);
}

double point_deviation(const std::vector<Vec3>& a, const std::vector<Vec3>& b, const RigidMotion& motion) {
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, (motion(a[k]) - b[k]).squaredNorm());
  return std::sqrt(largest);
}

double deviation_under(const Body& a, const Body& b, const RigidMotion& motion, double tolerance) {
  double largest = point_deviation(a.surface.points, b.surface.points, motion);
  if (!(largest <= tolerance)) return infinity;
  for (const auto& [x, y] : {std::pair{&a.start, &b.start}, std::pair{&a.end, &b.end}}) {
    largest = std::max(largest, point_deviation(x->surface.points, y->surface.points, motion));
    if (x->style != EndStyle::planar) continue;
    // The end curve lies in the plane as well as it did where the plane is the same.
    largest = std::max(largest, (motion(x->origin) - y->origin).norm());
    largest = std::max(largest, (motion.rotation * x->normal - y->normal).norm() * std::sqrt(b.end_area));
  }
  return largest;
}

// Rotations by right angles are what they mean.
Eigen::Matrix3d without_rounding(const Eigen::Matrix3d& rotation) {
  const Eigen::Matrix3d whole = rotation.array().round().matrix();
  return (rotation - whole).cwiseAbs().maxCoeff() < 1e-12 ? whole : rotation;
}

}  // namespace

Invariants invariants_of(const Body& body) {
  const std::vector<Vec3>& points = body.surface.points;
  const Vec3 centre = mean_of(points);
  double squares = 0;
  for (const Vec3& p : points) squares += (p - centre).squaredNorm();
  return {{std::sqrt(squares / static_cast<double>(points.size())), (points.front() - centre).norm(),
           (points[points.size() / 3] - centre).norm(), (points.back() - centre).norm()}};
}

bool are_alike(const Invariants& a, const Invariants& b, double tolerance) {
  for (std::size_t k = 0; k < a.sizes.size(); ++k)
    if (!(std::abs(a.sizes[k] - b.sizes[k]) <= 4 * tolerance)) return false;
  return true;
}

std::optional<Congruence> congruence(const Body& first, const Body& second, double tolerance) {
  if (!have_one_form(first, second)) return std::nullopt;
  const double basis = std::max({basis_deviation(first.surface, second.surface),
                                 basis_deviation(first.start.surface, second.start.surface),
                                 basis_deviation(first.end.surface, second.end.surface)});
  if (!(basis <= tolerance)) return std::nullopt;
  const std::vector<Vec3>&a = first.surface.points, &b = second.surface.points;
  Congruence found;
  found.motion.offset = b.front() - a.front();
  found.deviation = basis + deviation_under(first, second, found.motion, tolerance);
  if (found.deviation <= tolerance) return found;
  found.motion.rotation = without_rounding(best_rotation(a, b));
  found.motion.offset = mean_of(b) - found.motion.rotation * mean_of(a);
  found.deviation = basis + deviation_under(first, second, found.motion, tolerance);
  if (found.deviation <= tolerance) return found;
  return std::nullopt;
}

}  // namespace selvage::yarn
