// A plane z = constant for the mesh tests.
#pragma once

#include "surface_mesh/triangle_mesh.h"

namespace selvage::test {

class Plane final : public fem::Support {
 public:
  explicit Plane(double z = 0.25) : z_(z) {}
  [[nodiscard]] Vec3 point(const Vec2& p) const override { return {p.x(), p.y(), z_}; }
  [[nodiscard]] Vec3 normal(const Vec2& /*p*/) const override { return Vec3::UnitZ(); }
  [[nodiscard]] Place nearest(const Vec2& /*start*/, const Vec3& target) const override {
    return {target.head<2>(), point(target.head<2>())};
  }

 private:
  double z_;
};

}  // namespace selvage::test
