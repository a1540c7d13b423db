#include "yarn/arcs.h"

#include <cmath>

namespace selvage::yarn {

ArcsAndSegments::ArcsAndSegments(const Vec3& start) {
  curve_.degree = 2;
  curve_.knots = {0, 0, 0};
  curve_.points = {start};
  curve_.weights = {1};
}

void ArcsAndSegments::segment(const Vec3& to) {
  const Vec3 from = curve_.points.back();
  if (to != from) piece(0.5 * (from + to), 1.0, to, (to - from).norm());
}

void ArcsAndSegments::arc(const Vec3& corner, const Vec3& to, double half_angle) {
  const double weight = std::cos(half_angle);
  // Speed at its ends is 2 weight |corner - end| / duration: 1, as on the segments.
  piece(corner, weight, to, 2.0 * weight * (corner - curve_.points.back()).norm());
}

nurbs::Curve ArcsAndSegments::finish() {
  curve_.knots.push_back(curve_.knots.back());
  const double total = curve_.knots.back();
  for (double& knot : curve_.knots) knot /= total;
  return std::move(curve_);
}

void ArcsAndSegments::piece(const Vec3& middle, double weight, const Vec3& to, double duration) {
  const double end = curve_.knots.back() + duration;
  curve_.points.push_back(middle);
  curve_.points.push_back(to);
  curve_.weights.push_back(weight);
  curve_.weights.push_back(1.0);
  curve_.knots.push_back(end);
  curve_.knots.push_back(end);
}

}  // namespace selvage::yarn
