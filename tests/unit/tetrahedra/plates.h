// Two plates of triangles with a gap between them, for the mesh tests.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/vec.h"
#include "tetrahedra/worker.h"
#include "unit/surface_mesh/plane.h"

namespace selvage::test {

struct ClosedSurface {
  std::vector<Vec3> points;
  std::vector<fem::Triangle> triangles;  // outward
};

// The disc between z = 0 and z = gap with triangles of about `edge` on both plates, whose inner points stand
// at different places (they are turned against each other).
inline ClosedSurface two_plates(double radius, double gap, double edge) {
  const int round = static_cast<int>(std::ceil(2 * std::numbers::pi * radius / edge));
  std::vector<Vec2> rim;
  for (int k = 0; k < round; ++k) {
    const double angle = 2 * std::numbers::pi * k / round;
    rim.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  const Plane plane;
  const fem::SizeField field(edge, 0.3, {});
  fem::PlanarRegion region;
  for (const Vec2& q : rim) region.add({plane.point(q), q});
  region.close(0);
  Result<fem::TriangleMesh> plate = fem::fill(region, plane, field);
  if (!plate) {
    ADD_FAILURE() << plate.error().text;
    return {};
  }
  // Turned by a number of rim points that is no symmetry of the lattice.
  const int turned = round / 7 + 1;
  const double angle = 2 * std::numbers::pi * turned / round;
  const auto count = static_cast<std::uint32_t>(plate->parameters.size()),
             n = static_cast<std::uint32_t>(round);
  ClosedSurface result;
  for (const Vec2& p : plate->parameters) result.points.emplace_back(p.x(), p.y(), 0);
  for (const Vec2& p : plate->parameters)
    result.points.emplace_back(std::cos(angle) * p.x() - std::sin(angle) * p.y(),
                               std::sin(angle) * p.x() + std::cos(angle) * p.y(), gap);
  for (const auto& t : plate->triangles) {
    result.triangles.push_back({t[0], t[2], t[1]});
    result.triangles.push_back({count + t[0], count + t[1], count + t[2]});
  }
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t a = k, b = (k + 1) % n;
    const std::uint32_t above_a = count + (k + n - static_cast<std::uint32_t>(turned)) % n;
    const std::uint32_t above_b = count + (k + 1 + n - static_cast<std::uint32_t>(turned)) % n;
    result.triangles.push_back({a, b, above_b});
    result.triangles.push_back({a, above_b, above_a});
  }
  return result;
}

}  // namespace selvage::test
