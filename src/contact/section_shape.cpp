#include "contact/section_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "nurbs/divided.h"
#include "nurbs/samples.h"

namespace selvage::contact {

std::vector<SectionShape> section_shapes(const nurbs::Surface& surface, const std::vector<double>& vs) {
  std::vector<double> us = nurbs::divided(surface.knots_u, surface.degree_u, 4);
  us.pop_back();  // it is the first again
  const nurbs::Samples samples(surface, us, vs);
  const std::size_t n = us.size();
  std::vector<SectionShape> shapes(vs.size());
  for (std::size_t j = 0; j < vs.size(); ++j) {
    const std::span<const Vec3> p = samples.row(j);
    Vec3 area = Vec3::Zero();
    for (std::size_t i = 1; i + 1 < n; ++i) area += 0.5 * (p[i] - p[0]).cross(p[i + 1] - p[0]);
    shapes[j].area = area.norm();
    const Vec3 normal = area.normalized();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 first = p[(i + 1) % n] - p[i], second = p[(i + 2) % n] - p[(i + 1) % n];
      // In the section's plane: a section of a bent yarn is not quite flat.
      const Vec3 a = first - first.dot(normal) * normal, b = second - second.dot(normal) * normal;
      if (a.norm() > 0.0 && b.norm() > 0.0)
        least = std::min(least, std::atan2(a.cross(b).dot(normal), a.dot(b)));
    }
    shapes[j].least_turning = least;
  }
  return shapes;
}

}  // namespace selvage::contact
