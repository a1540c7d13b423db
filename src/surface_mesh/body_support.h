// A yarn's surface for triangles to lie on.
#pragma once

#include <algorithm>
#include <cmath>

#include "cell/cut.h"
#include "surface_mesh/triangle_mesh.h"
#include "yarn/body.h"

namespace selvage::fem {

// The body outlives it. Where it goes round, parameters may be any number of periods off.
class BodySupport final : public Support {
 public:
  explicit BodySupport(const yarn::Body& body) : body_(body) {}

  [[nodiscard]] Vec3 point(const Vec2& q) const override { return cell::position(body_, q); }

  [[nodiscard]] Vec3 normal(const Vec2& q) const override {
    const nurbs::SurfaceJet s = cell::jet(body_, q);
    return s.du.cross(s.dv).stableNormalized();
  }

  // Gauss-Newton's method.
  [[nodiscard]] Place nearest(const Vec2& start, const Vec3& target) const override {
    Vec2 q = start;
    for (int step = 0; step < 8; ++step) {
      const nurbs::SurfaceJet s = cell::jet(body_, q);
      const Vec3 way = target - s.position;
      const double a = s.du.squaredNorm(), b = s.du.dot(s.dv), c = s.dv.squaredNorm();
      const double determinant = a * c - b * b;
      if (!(determinant > 1e-12 * a * c)) break;
      const double x = s.du.dot(way), y = s.dv.dot(way);
      Vec2 change((c * x - b * y) / determinant, (a * y - b * x) / determinant);
      const double size = std::sqrt(a) * std::abs(change.x()) + std::sqrt(c) * std::abs(change.y());
      q += change;
      if (!body_.closed_along) q.y() = std::clamp(q.y(), body_.surface.first_v(), body_.surface.last_v());
      if (size < 1e-4 * way.norm() + 1e-14) break;
    }
    return {q, point(q)};
  }

  [[nodiscard]] Vec2 beside(const Vec2& a, const Vec2& b) const override { return cell::beside(body_, a, b); }

 private:
  const yarn::Body& body_;
};

}  // namespace selvage::fem
