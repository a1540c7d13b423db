#include "formats/iges/placement.h"

#include "cad/edges.h"

namespace selvage::formats::iges {

Placement Placement::of(const Eigen::Matrix3d& linear, const Vec3& shift) {
  return {linear, shift, linear == Eigen::Matrix3d::Identity() && shift == Vec3::Zero()};
}

Placement Placement::operator*(const Placement& inner) const {
  if (is_identity) return inner;
  if (inner.is_identity) return *this;
  return of(linear * inner.linear, linear * inner.shift + shift);
}

void Placement::apply(std::vector<Vec3>& points) const {
  if (is_identity) return;
  for (Vec3& point : points) point = (*this)(point);
}

void Placement::apply(std::vector<nurbs::Curve>& curves) const {
  for (nurbs::Curve& curve : curves) apply(curve);
}

void Placement::apply(cad::Face& face) const {
  apply(face.surface);
  for (cad::Edge& edge : cad::boundary_edges_of(face)) apply(edge.curve);
}

void Placement::apply(cad::Part& part) const {
  const bool turns = part.kind != cad::Part::Kind::surfaces && mirrors();
  for (cad::Face& face : part.faces) {
    apply(face);
    if (turns) face.reversed = !face.reversed;
  }
}

}  // namespace selvage::formats::iges
