#include "yarn/end_plane.h"

#include "nurbs/sweep.h"
#include "yarn/ends.h"
#include "yarn/rigid_fit.h"

namespace selvage::yarn {

nurbs::Curve EndPlane::in_parameters(const nurbs::Curve& curve) const {
  nurbs::Curve flat = curve;
  for (Vec3& point : flat.points) {
    const Vec3 offset = point - origin;
    point = Vec3(offset.dot(axis_u), offset.dot(axis_v), 0);
  }
  return flat;
}

EndPlane end_plane(const Body& body, const nurbs::Curve& end_curve, bool last) {
  EndPlane plane;
  // From the outline alone, so that a yarn that was read from a file has the same plane, to the bit.
  plane.origin = mean_of(std::span(end_curve.points).subspan(1));
  // Where u runs counter-clockwise seen along the path, the yarn's own direction is the normal for it.
  plane.inward = last == body.inward;
  plane.normal = area_vector(end_curve).normalized();
  Vec3 across = end_curve.points.front() - plane.origin;
  across -= across.dot(plane.normal) * plane.normal;
  plane.axis_u = across.norm() > 0 ? Vec3(across.normalized()) : plane.normal.unitOrthogonal();
  plane.axis_v = plane.normal.cross(plane.axis_u).normalized();

  Vec2 low = Vec2::Zero(), high = Vec2::Zero();
  for (const Vec3& point : plane.in_parameters(end_curve).points) {
    low = low.cwiseMin(point.head<2>());
    high = high.cwiseMax(point.head<2>());
  }
  const Vec2 margin = Vec2::Constant(0.1 * (high - low).maxCoeff());
  low -= margin;
  high += margin;

  plane.surface = nurbs::flat(plane.origin, plane.axis_u, plane.axis_v, low, high);
  return plane;
}

}  // namespace selvage::yarn
