#include "yarn/in_axes.h"

namespace selvage::yarn {

namespace {

void bring(std::vector<Vec3>& points, const ObliqueAxes& axes) {
  for (Vec3& point : points) point = axes.own(point);
}

void bring(EndFace& end, const ObliqueAxes& axes) {
  bring(end.surface.points, axes);
  end.origin = axes.own(end.origin);
  // A normal goes with the planes.
  end.normal = unit_or_zero(axes.to_space().transpose() * end.normal);
}

Body brought(Body body, const ObliqueAxes& axes) {
  bring(body.surface.points, axes);
  bring(body.axis.points, axes);
  bring(body.start, axes);
  bring(body.end, axes);
  body.shape = 0;
  body.volume *= axes.to_own().determinant();
  return body;
}

}  // namespace

BodiesInAxes::BodiesInAxes(std::span<const Body> bodies, const ObliqueAxes& axes) : list_(bodies) {
  if (axes.are_of_space()) return;
  made_.reserve(bodies.size());
  for (const Body& body : bodies) made_.push_back(brought(body, axes));
  list_ = made_;
}

}  // namespace selvage::yarn
