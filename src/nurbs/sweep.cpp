#include "nurbs/sweep.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "nurbs/chain.h"
#include "nurbs/conic.h"

namespace selvage::nurbs {

Surface ruled(const Curve& first, const Curve& second) {
  Curve a = first, b = second;
  make_compatible(a, b);
  Surface surface;
  surface.degree_u = a.degree;
  surface.degree_v = 1;
  surface.count_u = static_cast<int>(a.points.size());
  surface.count_v = 2;
  surface.knots_u = a.knots;
  surface.knots_v = {0, 0, 1, 1};
  surface.points = a.points;
  surface.points.insert(surface.points.end(), b.points.begin(), b.points.end());
  surface.weights = a.weights;
  surface.weights.insert(surface.weights.end(), b.weights.begin(), b.weights.end());
  return surface;
}

Surface extruded(const Curve& directrix, const Vec3& shift) {
  Surface surface;
  surface.degree_u = directrix.degree;
  surface.degree_v = 1;
  surface.count_u = static_cast<int>(directrix.points.size());
  surface.count_v = 2;
  surface.knots_u = directrix.knots;
  surface.knots_v = {0, 0, 1, 1};
  surface.points = directrix.points;
  for (const Vec3& p : directrix.points) surface.points.push_back(p + shift);
  surface.weights = directrix.weights;
  surface.weights.insert(surface.weights.end(), directrix.weights.begin(), directrix.weights.end());
  return surface;
}

Surface revolved(const Curve& generatrix, const Vec3& foot, const Vec3& direction, double from, double to) {
  const Vec3 axis = direction.normalized();
  double size = 0;
  for (const Vec3& p : generatrix.points) size = std::max(size, (p - foot).norm());
  Surface surface;
  surface.degree_u = generatrix.degree;
  surface.degree_v = 2;
  surface.count_u = static_cast<int>(generatrix.points.size());
  surface.knots_u = generatrix.knots;
  for (std::size_t i = 0; i < generatrix.points.size(); ++i) {
    const Vec3 offset = generatrix.points[i] - foot;
    const double height = offset.dot(axis);
    Vec3 radial = offset - height * axis;
    if (radial.norm() <= 1e-13 * size) radial.setZero();
    const Curve circle = elliptic_arc(generatrix.points[i] - radial, radial, axis.cross(radial), from, to);
    if (i == 0) {
      surface.count_v = static_cast<int>(circle.points.size());
      surface.knots_v = circle.knots;
      surface.points.resize(generatrix.points.size() * circle.points.size());
      surface.weights.resize(surface.points.size());
    }
    const double weight = generatrix.is_rational() ? generatrix.weights[i] : 1.0;
    for (int j = 0; j < surface.count_v; ++j) {
      const auto k = static_cast<std::size_t>(j);
      surface.point(static_cast<int>(i), j) = circle.points[k];
      surface.weights[surface.index(static_cast<int>(i), j)] = weight * circle.weights[k];
    }
  }
  return surface;
}

}  // namespace selvage::nurbs
