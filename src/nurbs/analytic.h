// Planes, cylinders, cones, spheres and tori, and the part of one that loops on it bound, as B-splines.
#pragma once

#include <optional>
#include <vector>

#include "nurbs/spline.h"

namespace selvage::nurbs {

// x, y, z: orthonormal, right-handed. In this frame, with the angle u about z from x:
//   plane: (u, v, 0); cylinder: radius r, height v; cone: radius r + v tan(half_angle) at height v;
//   sphere: latitude v; torus: the circle of radius `minor` at the angle v from the plane z = 0.
// S_u x S_v points along z (plane), else away from the axis (sphere: centre, torus: core).
struct Analytic {
  enum class Kind { plane, cylinder, cone, sphere, torus };
  Kind kind = Kind::plane;
  Vec3 origin = Vec3::Zero(), x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  double radius = 0;      // but for planes
  double half_angle = 0;  // cone, radians, below pi / 2
  double minor = 0;       // torus

  // With the axis along `axis` and x as near to `reference` as can be (zero: any).
  static Analytic placed(Kind kind, const Vec3& origin, const Vec3& axis, const Vec3& reference);

  [[nodiscard]] bool is_finite() const { return kind == Kind::sphere || kind == Kind::torus; }
  // A rectangle of the parameters, angles as in elliptic_arc (nurbs/conic.h): exact.
  struct Range {
    double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  };
  [[nodiscard]] Range whole() const;  // of a finite one
  [[nodiscard]] Surface part(const Range& range) const;

  // S_u x S_v / |S_u x S_v| at the angle u and height or angle v.
  [[nodiscard]] Vec3 normal(double u, double v) const;
  // At a distance along that normal, exactly; nothing where there is no such surface (a radius of 0 or less).
  [[nodiscard]] std::optional<Analytic> at_distance(double distance) const;

  // The parameters of the point below `p`; u means nothing on the axis.
  [[nodiscard]] Vec2 parameters(const Vec3& p) const;
  [[nodiscard]] bool is_on_axis(const Vec3& p) const;

  // The smallest rectangle that holds what the loops bound; each is a row of points on the surface, dense
  // enough that neighbours are less than half a turn apart, the first one to follow the last one, and has
  // what it bounds on its left, seen from outside. Round an axis it begins where a loop does that goes round
  // it. Nothing where the loops bound nothing.
  [[nodiscard]] std::optional<Range> bounded_by(const std::vector<std::vector<Vec3>>& loops) const;
  // The same with a margin on every side, as far as there is room.
  [[nodiscard]] Range widened(const Range& range) const;
};

}  // namespace selvage::nurbs
