#include "fem/quality.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fem/faces.h"
#include "fem/materials.h"

namespace selvage::fem {
namespace {

std::array<Vec3, 4> regular() {
  return {Vec3(1, 1, 1), Vec3(-1, -1, 1), Vec3(-1, 1, -1), Vec3(1, -1, -1)};
}

std::array<Vec3, 10> ten(const std::array<Vec3, 4>& corners) {
  std::array<Vec3, 10> nodes;
  for (std::size_t k = 0; k < 4; ++k) nodes[k] = corners[k];
  for (std::size_t k = 0; k < 6; ++k)
    nodes[4 + k] = (corners[edge_ends[k][0]] + corners[edge_ends[k][1]]) / 2;
  return nodes;
}

TEST(Quality, RegularTetrahedron) {
  std::array<Vec3, 4> corners = regular();
  ElementShape shape = shape_of(corners);
  if (shape.scaled_jacobian < 0) {
    std::swap(corners[2], corners[3]);
    shape = shape_of(corners);
  }
  EXPECT_NEAR(shape.min_dihedral, 70.52877936550931, 1e-9);
  EXPECT_NEAR(shape.max_dihedral, 70.52877936550931, 1e-9);
  EXPECT_NEAR(shape.aspect, 1, 1e-12);
  EXPECT_NEAR(shape.scaled_jacobian, 1, 1e-12);
  std::swap(corners[0], corners[1]);
  EXPECT_NEAR(shape_of(corners).scaled_jacobian, -1, 1e-12);
}

TEST(Quality, CornerOfACube) {
  const ElementShape shape = shape_of({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)});
  EXPECT_NEAR(shape.max_dihedral, 90, 1e-9);
  EXPECT_NEAR(shape.min_dihedral, std::acos(1 / std::sqrt(3.0)) * 180 / 3.14159265358979324, 1e-9);
  // Longest edge sqrt 2, height on the oblique face 1 / sqrt 3.
  EXPECT_NEAR(shape.aspect, std::sqrt(2.0) * std::sqrt(3.0) * std::sqrt(2.0 / 3), 1e-12);
  // Product of edges at an oblique corner: 1 sqrt2 sqrt2.
  EXPECT_NEAR(shape.scaled_jacobian, std::sqrt(2.0) / 2, 1e-12);
}

// A quadratic map keeps ten-node elements exact: x + a y^2 has determinant 1 everywhere, x + a x^2 has 1 + 2
// a x.
TEST(Quality, CurvedElements) {
  const std::array<Vec3, 4> corners = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  std::array<Vec3, 10> shear = ten(corners), stretch = ten(corners);
  for (Vec3& p : shear) p.x() += 0.8 * p.y() * p.y();
  EXPECT_NEAR(least_jacobian_share(ten(corners)), 1, 1e-14);
  EXPECT_NEAR(quadratic_volume(shear), 1.0 / 6, 1e-14);
  const double sheared_corners = (shear[1] - shear[0]).cross(shear[2] - shear[0]).dot(shear[3] - shear[0]);
  EXPECT_NEAR(least_jacobian_share(shear), 1 / sheared_corners, 1e-13);
  // Volume 1/6 + 2 a int x dV, int x dV = 1/24; smallest determinant at x = 1 for a < 0, corner tetrahedron 1
  // + a.
  const double a = -0.3;
  for (Vec3& p : stretch) p.x() += a * p.x() * p.x();
  EXPECT_NEAR(quadratic_volume(stretch), 1.0 / 6 + 2 * a / 24, 1e-14);
  EXPECT_NEAR(least_jacobian_share(stretch), (1 + 2 * a) / (1 + a), 1e-13);
}

TEST(Materials, OfTheFileGenericAndWithoutConstants) {
  fabric::Fabric fabric;
  fabric.materials.resize(2);
  fabric.materials[0].name = "glass";
  fabric.materials[0].elastic = fabric::IsotropicElastic{.modulus = 72400, .poisson = 0.22};
  fabric.materials[1].name = "wool";
  std::vector<yarn::Body> bodies(4);
  bodies[0].material = "glass";
  bodies[1].material = "wool";
  bodies[3].material = "glass";
  Diagnostics diagnostics;
  const MaterialChoice choice = choose_materials(fabric, bodies, diagnostics);
  EXPECT_EQ(choice.of_body, (std::vector<std::string>{"glass", "wool", "generic", "glass"}));
  ASSERT_EQ(choice.materials.size(), 3U);
  EXPECT_EQ(std::get<fabric::IsotropicElastic>(choice.materials[0].elastic).modulus, 72400);
  EXPECT_EQ(std::get<fabric::IsotropicElastic>(choice.materials[1].elastic).modulus, 10000);
  EXPECT_EQ(diagnostics.messages().size(), 2U);  // wool has no constants, one yarn no material
  EXPECT_FALSE(diagnostics.has_errors());
}

}  // namespace
}  // namespace selvage::fem
