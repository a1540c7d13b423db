#include "formats/iges/placement.h"

namespace selvage::formats::iges {

Placement Placement::of(const Eigen::Matrix3d& linear, const Vec3& shift) {
  return {linear, shift, linear == Eigen::Matrix3d::Identity() && shift == Vec3::Zero()};
}

Placement Placement::operator*(const Placement& inner) const {
  if (is_identity) return inner;
  if (inner.is_identity) return *this;
  return of(linear * inner.linear, linear * inner.shift + shift);
}

void Placement::apply(nurbs::Curve& curve) const {
  if (is_identity) return;
  for (Vec3& point : curve.points) point = (*this)(point);
}

void Placement::apply(nurbs::Surface& surface) const {
  if (is_identity) return;
  for (Vec3& point : surface.points) point = (*this)(point);
}

void Placement::apply(cad::Face& face) const {
  if (is_identity) return;
  apply(face.surface);
  for (cad::Loop& loop : face.loops)
    for (cad::Edge& edge : loop.edges) apply(edge.curve);
}

void Placement::apply(cad::Part& part) const {
  if (is_identity) return;
  const bool turns = part.kind != cad::Part::Kind::surfaces && mirrors();
  for (cad::Face& face : part.faces) {
    apply(face);
    if (turns) face.reversed = !face.reversed;
  }
}

}  // namespace selvage::formats::iges
