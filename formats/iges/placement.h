// Transformations (124) applied to geometry.
#pragma once

#include "cad/model.h"
#include "core/vec.h"

namespace selvage::formats::iges {

// p -> linear p + shift. The identity leaves every bit as it is.
struct Placement {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Vec3 shift = Vec3::Zero();
  bool is_identity = true;

  static Placement of(const Eigen::Matrix3d& linear, const Vec3& shift);
  static Placement scaling(double factor) { return of(factor * Eigen::Matrix3d::Identity(), Vec3::Zero()); }

  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return is_identity ? p : Vec3(linear * p + shift); }
  // First `inner`, then this.
  [[nodiscard]] Placement operator*(const Placement& inner) const;
  [[nodiscard]] bool mirrors() const { return !is_identity && linear.determinant() < 0; }

  void apply(nurbs::Curve& curve) const { apply(curve.points); }
  void apply(std::vector<nurbs::Curve>& curves) const;
  void apply(nurbs::Surface& surface) const { apply(surface.points); }
  void apply(cad::Face& face) const;  // its surface and the curves in space; not `reversed`
  void apply(cad::Part& part) const;  // faces of shells and solids keep their outsides outside

 private:
  void apply(std::vector<Vec3>& points) const;
};

}  // namespace selvage::formats::iges
