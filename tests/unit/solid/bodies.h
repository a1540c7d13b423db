// Yarns made by hand whose volumes, gaps and overlaps are known in closed form.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "yarn/finish.h"
#include "yarn/grid.h"

namespace selvage::test {

using Place = std::function<Vec3(double along, double x, double y)>;  // x, y: in the section

// The control polygon of a closed quadratic whose curve is a circle of radius 1 to 1e-6 (m = 64).
inline Vec2 unit_circle(int i, int m) {
  const double angle = 2.0 * std::numbers::pi * (i + 0.5) / m, radius = 1.0 / std::cos(std::numbers::pi / m);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

struct TubeForm {
  double a = 1, b = 1;  // half axes of the elliptic section
  int round = 64;       // control points round
  int sections = 8;     // control sections
  bool closed = false;
  yarn::EndStyle ends = yarn::EndStyle::patch;
};

// Control sections at along = 0 .. 1 (closed: 0 .. 1 - 1/sections), placed by `place`.
inline yarn::Body tube(const std::string& name, const TubeForm& form, const Place& place) {
  yarn::GridNet net;
  net.sections = form.sections;
  net.per_section = form.round;
  net.closed_along = form.closed;
  for (int j = 0; j < form.sections; ++j)
    for (int i = 0; i < form.round; ++i) {
      const Vec2 p = unit_circle(i, form.round);
      net.points.push_back(place(j / static_cast<double>(form.closed ? form.sections : form.sections - 1),
                                 form.a * p.x(), form.b * p.y()));
    }
  yarn::Body body;
  body.name = name;
  Status filled = yarn::fill_from_grid(body, net);
  EXPECT_TRUE(filled.ok()) << (filled.ok() ? "" : to_string(filled.error()));
  Status finished = yarn::finish(body, form.ends);
  EXPECT_TRUE(finished.ok()) << (finished.ok() ? "" : to_string(finished.error()));
  return body;
}

inline yarn::Body moved(yarn::Body body, const Vec3& by) {
  for (nurbs::Surface* s : {&body.surface, &body.start.surface, &body.end.surface})
    for (Vec3& p : s->points) p += by;
  for (Vec3& p : body.axis.points) p += by;
  body.start.origin += by;
  body.end.origin += by;
  return body;
}

// A straight tube through `middle`, `length` long in the direction `along`; the section's x axis is `across`
// (made perpendicular), its y axis along x across.
inline yarn::Body straight(const std::string& name, const TubeForm& form, const Vec3& middle,
                           const Vec3& along, const Vec3& across, double length) {
  const Vec3 t = along.normalized(), x = (across - across.dot(t) * t).normalized(), y = t.cross(x);
  return tube(name, form, [=](double s, double u, double v) -> Vec3 {
    return middle + (s - 0.5) * length * t + u * x + v * y;
  });
}

// Round the z axis. 48 sections, so that the control circle's radius needs its correction only in the 7th
// digit: the curve of a uniform cubic over a circle of m points has the radius R (2 + cos(2 pi / m)) / 3 at
// its knots.
inline yarn::Body ring(const std::string& name, double radius, double section_radius,
                       const Vec3& middle = Vec3::Zero()) {
  constexpr int m = 64;
  TubeForm form{section_radius, section_radius, 64, m, true, yarn::EndStyle::patch};
  const double grow = 3.0 / (2.0 + std::cos(2.0 * std::numbers::pi / m));
  return tube(name, form, [=](double s, double u, double v) -> Vec3 {
    const double phi = 2.0 * std::numbers::pi * s, r = (radius + u) * grow;
    return middle + Vec3(r * std::cos(phi), r * std::sin(phi), v);
  });
}

}  // namespace selvage::test
