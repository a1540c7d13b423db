#include "surface_mesh/end_cap.h"

#include <algorithm>
#include <cmath>

#include "core/plane.h"

namespace selvage::fem {

EndCap::EndCap(const std::vector<Vec3>& rim, const yarn::EndFace& face) : face_(&face) {
  origin_ = Vec3::Zero();
  for (const Vec3& point : rim) origin_ += point / static_cast<double>(rim.size());
  normal_ = Vec3::Zero();
  for (std::size_t i = 0; i < rim.size(); ++i)
    normal_ += (rim[i] - origin_).cross(rim[(i + 1) % rim.size()] - origin_);
  normal_.normalize();
  // The first axis along the longest radius, so that lattices follow a flat section.
  Vec3 longest = Vec3::Zero();
  for (const Vec3& point : rim) {
    const Vec3 radius = point - origin_;
    const Vec3 level = radius - normal_ * normal_.dot(radius);
    if (level.squaredNorm() > longest.squaredNorm()) longest = level;
  }
  extent_ = longest.norm();
  across_ = longest / extent_;
  up_ = normal_.cross(across_);
  double highest = 0;
  for (const Vec3& point : rim) {
    rim_.push_back(project(point));
    heights_.push_back(normal_.dot(point - origin_));
    highest = std::max(highest, std::abs(heights_.back()));
  }
  is_flat_ = highest <= 1e-10 * extent_;
  const nurbs::Surface& surface = face.surface;
  if (is_flat_ || surface.is_empty()) return;
  constexpr int steps = 16;
  for (int j = 0; j <= steps; ++j)
    for (int i = 0; i <= steps; ++i) {
      const double s = static_cast<double>(i) / steps, t = static_cast<double>(j) / steps;
      seeds_.emplace_back(surface.first_u() + s * (surface.last_u() - surface.first_u()),
                          surface.first_v() + t * (surface.last_v() - surface.first_v()));
      seed_places_.push_back(project(nurbs::evaluate(surface, seeds_.back().x(), seeds_.back().y())));
    }
}

Vec2 EndCap::project(const Vec3& point) const {
  return {across_.dot(point - origin_), up_.dot(point - origin_)};
}

Vec3 EndCap::lift(const Vec2& point) const {
  double height = 0;
  if (!is_flat_) {
    const std::optional<double> found = surface_height(point);
    height = found ? *found : blended_height(point);
  }
  return origin_ + across_ * point.x() + up_ * point.y() + normal_ * height;
}

// Newton's method in the plane from the nearest seed.
std::optional<double> EndCap::surface_height(const Vec2& point) const {
  if (seeds_.empty()) return std::nullopt;
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < seeds_.size(); ++i)
    if ((seed_places_[i] - point).squaredNorm() < (seed_places_[nearest] - point).squaredNorm()) nearest = i;
  const nurbs::Surface& surface = face_->surface;
  const Vec2 low(surface.first_u(), surface.first_v()), high(surface.last_u(), surface.last_v());
  Vec2 at = seeds_[nearest];
  for (int step = 0; step < 30; ++step) {
    const nurbs::SurfaceJet jet = nurbs::evaluate_jet(surface, at.x(), at.y());
    const Vec2 miss = project(jet.position) - point;
    if (miss.norm() <= 1e-12 * extent_) return normal_.dot(jet.position - origin_);
    Eigen::Matrix2d slope;
    slope << across_.dot(jet.du), across_.dot(jet.dv), up_.dot(jet.du), up_.dot(jet.dv);
    const double determinant = slope.determinant();
    if (!(std::abs(determinant) > 1e-14 * slope.squaredNorm())) return std::nullopt;
    at = (at - slope.inverse() * miss).cwiseMax(low).cwiseMin(high);
  }
  return std::nullopt;
}

double EndCap::blended_height(const Vec2& point) const {
  const std::size_t n = rim_.size();
  double sum = 0, weights = 0;
  auto half_tangent = [&](std::size_t i) {
    const Vec2 a = rim_[i] - point, b = rim_[(i + 1) % n] - point;
    const double dot = a.dot(b) + a.norm() * b.norm();
    return dot == 0 ? 0.0 : cross(a, b) / dot;  // tan(angle / 2)
  };
  double before = half_tangent(n - 1);
  for (std::size_t i = 0; i < n; ++i) {
    const double distance = (rim_[i] - point).norm();
    if (distance <= 1e-12 * extent_) return heights_[i];
    const double after = half_tangent(i);
    const double weight = (before + after) / distance;
    sum += weight * heights_[i];
    weights += weight;
    before = after;
  }
  return weights == 0 ? 0.0 : sum / weights;
}

}  // namespace selvage::fem
