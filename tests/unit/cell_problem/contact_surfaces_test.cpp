#include "cell_problem/contact_surfaces.h"

#include <gtest/gtest.h>

namespace selvage::fem {
namespace {

// A straight yarn of `count` bricks with sides of 1 along `along` (0 or 1) from `start`.
void add_yarn(Mesh& mesh, const Vec3& start, int along, int count) {
  Region region;
  region.first_element = mesh.elements.size();
  const std::size_t first = mesh.nodes.size();
  const Vec3 step = Vec3::Unit(along), across = along == 0 ? Vec3(0, 1, 0) : Vec3(-1, 0, 0);
  for (int k = 0; k <= count; ++k)
    for (const Vec3& corner : {Vec3(0, 0, 0), across, Vec3(across + Vec3(0, 0, 1)), Vec3(0, 0, 1)})
      mesh.nodes.emplace_back(start + k * step + corner);
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
    const std::size_t a = first + 4 * k, b = a + 4;
    mesh.elements.push_back({a, b, b + 1, a + 1, a + 3, b + 3, b + 2, a + 2});
  }
  region.last_element = mesh.elements.size();
  region.volume = count;
  mesh.regions.push_back(region);
}

// Two layers of n yarns, two apart, across each other and a tenth of their thickness apart: n^2 crossings.
Mesh grid(int n) {
  Mesh mesh;
  mesh.shape = Mesh::Shape::hexahedron;
  for (int k = 0; k < n; ++k) add_yarn(mesh, {0, 2.0 * k, 0}, 0, 2 * n);
  for (int k = 0; k < n; ++k) add_yarn(mesh, {2.0 * k + 1, 0, 1.1}, 1, 2 * n);
  return mesh;
}

TEST(ContactSurfaces, PairsAreTheYarnsThatCross) {
  const ContactSurfaces found = contact_surfaces(grid(3));
  std::vector<std::array<std::size_t, 2>> wanted;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 3; b < 6; ++b) wanted.push_back({a, b});
  EXPECT_EQ(found.pairs, wanted);
}

// Of a cloth with four times as many crossings four times as many distances are measured, not sixteen times.
TEST(ContactSurfaces, TheWorkGrowsWithTheMesh) {
  std::size_t before = 0, facets = 0;
  for (const int n : {8, 16, 32}) {
    const Mesh mesh = grid(n);
    const ContactSurfaces found = contact_surfaces(mesh);
    EXPECT_EQ(found.pairs.size(), static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
    std::size_t sides = 0;
    for (const ContactSurface& surface : found.surfaces) sides += surface.whole.size();
    EXPECT_LT(found.distances, 4 * sides);
    if (before > 0) {
      EXPECT_LT(static_cast<double>(found.distances) / static_cast<double>(before),
                1.1 * static_cast<double>(sides) / static_cast<double>(facets));
    }
    before = found.distances;
    facets = sides;
  }
}

}  // namespace
}  // namespace selvage::fem
