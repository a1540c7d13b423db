#include "nurbs/sweep.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "nurbs/chain.h"
#include "nurbs/conic.h"

namespace selvage::nurbs {

Surface ruled(const Curve& first, const Curve& second) {
  Curve a = first, b = second;
  make_compatible(a, b);
  Surface surface = ruled(a, b.points);
  std::copy(b.weights.begin(), b.weights.end(), surface.weights.end() - std::ssize(b.weights));
  return surface;
}

Surface ruled(const Curve& first, const std::vector<Vec3>& second) {
  Surface surface;
  surface.degree_u = first.degree;
  surface.degree_v = 1;
  surface.count_u = static_cast<int>(first.points.size());
  surface.count_v = 2;
  surface.knots_u = first.knots;
  surface.knots_v = {0, 0, 1, 1};
  surface.points = first.points;
  surface.points.insert(surface.points.end(), second.begin(), second.end());
  surface.weights = first.weights;
  surface.weights.insert(surface.weights.end(), first.weights.begin(), first.weights.end());
  return surface;
}

Surface extruded(const Curve& directrix, const Vec3& shift) {
  std::vector<Vec3> shifted;
  for (const Vec3& p : directrix.points) shifted.push_back(p + shift);
  return ruled(directrix, shifted);
}

Surface flat(const Vec3& origin, const Vec3& x, const Vec3& y, const Vec2& low, const Vec2& high) {
  Surface surface;
  surface.degree_u = surface.degree_v = 1;
  surface.count_u = surface.count_v = 2;
  surface.knots_u = {low.x(), low.x(), high.x(), high.x()};
  surface.knots_v = {low.y(), low.y(), high.y(), high.y()};
  for (const double v : {low.y(), high.y()})
    for (const double u : {low.x(), high.x()}) surface.points.emplace_back(origin + u * x + v * y);
  return surface;
}

Surface revolved(const Curve& generatrix, const Vec3& foot, const Vec3& direction, double from, double to) {
  const Vec3 axis = direction.normalized();
  double size = 0;
  for (const Vec3& p : generatrix.points) size = std::max(size, (p - foot).norm());
  std::vector<Curve> circles;
  for (std::size_t i = 0; i < generatrix.points.size(); ++i) {
    const Vec3 offset = generatrix.points[i] - foot;
    const double height = offset.dot(axis);
    Vec3 radial = offset - height * axis;
    if (radial.norm() <= 1e-13 * size) radial.setZero();
    circles.push_back(elliptic_arc(generatrix.points[i] - radial, radial, axis.cross(radial), from, to));
    for (double& weight : circles.back().weights) weight *= generatrix.weight(i);
  }
  return of_columns(generatrix.degree, generatrix.knots, circles);
}

}  // namespace selvage::nurbs
