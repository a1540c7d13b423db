// Yarns for the tests of the solids, made from control grids whose shape is known.
#pragma once

#include "unit/fem/bodies.h"

namespace selvage::tests {

using Place = std::function<Vec3(double round, double along)>;  // both in [0, 1]

inline yarn::Body grid_body(const std::string& name, yarn::EndStyle ends, int per_section, int sections,
                            bool ring, const Place& place) {
  const auto point = [&](double angle, double along) {
    return place((angle + std::numbers::pi / per_section) / (2 * std::numbers::pi), along);
  };
  return test::grid_body(name, per_section, sections, point, ring, ends);
}

inline Vec3 turn(double round) {
  const double angle = 2 * std::numbers::pi * round;
  return {std::cos(angle), std::sin(angle), 0.0};
}

// A straight tube along z, of elliptic section; `size` stretches all of it.
inline yarn::Body tube(const std::string& name, yarn::EndStyle ends, double size = 1.0,
                       const Vec3& at = Vec3::Zero()) {
  return grid_body(name, ends, 16, 6, false, [&](double round, double along) -> Vec3 {
    const Vec3 p = turn(round);
    return size * Vec3(0.8 * p.x(), 0.5 * p.y(), 5.0 * along) + at;
  });
}

// 16 x 16 control points that wave in z along y, as a warp of a plain weave does: 18 x 16 in clamped form.
inline yarn::Body wave(const std::string& name, yarn::EndStyle ends, double size = 1.0,
                       const Vec3& at = Vec3::Zero()) {
  return grid_body(name, ends, 16, 16, false, [&](double round, double along) -> Vec3 {
    const Vec3 p = turn(round);
    const double phase = 2 * std::numbers::pi * along;
    const Vec3 tangent = Vec3(0.0, 4.0, -0.4 * 2 * std::numbers::pi * std::sin(phase)).normalized();
    const Vec3 up(0.0, -tangent.z(), tangent.y());
    return size * (Vec3(0.0, 4.0 * along, 0.4 * std::cos(phase)) + 0.45 * p.x() * Vec3::UnitX() +
                   0.2 * p.y() * up) +
           at;
  });
}

// Diameter d of the section, radius R of the axis. The control points stand a little outside, so that the
// B-spline passes through the torus at its knots: a periodic cubic falls short by (2 + cos h) / 3, a
// quadratic by cos(h / 2).
inline yarn::Body ring(const std::string& name, double diameter, double radius) {
  const int per_section = 48, sections = 96;
  const double h = 2 * std::numbers::pi / sections;
  const double stretch = 3.0 / (2.0 + std::cos(h));
  const double reach = 0.5 * diameter / std::cos(std::numbers::pi / per_section);
  return grid_body(name, yarn::EndStyle::patch, per_section, sections, true,
                   [&](double round, double along) -> Vec3 {
                     const Vec3 p = turn(round), direction = turn(along);
                     return (radius + reach * p.x()) * stretch * direction + Vec3(0, 0, reach * p.y());
                   });
}

}  // namespace selvage::tests
