// What bonding makes of a gap between two plates, by its volume and the area that is shared then.
#include "cell_problem/bond.h"

#include <gtest/gtest.h>

#include <numbers>

#include "core/module.h"
#include "tetrahedra/improve.h"
#include "tetrahedra/worker.h"
#include "unit/tetrahedra/plates.h"

namespace selvage::fem {
namespace {

struct Slab {
  TetMesh mesh;
  std::vector<std::uint32_t> yarns;
};

// Between yarn 0 below and yarn 1 above; the matrix is 2.
Slab slab(double radius, double gap, double edge) {
  Slab result;
  const test::ClosedSurface surface = test::two_plates(radius, gap, edge);
  const Result<std::filesystem::path> program = find_worker("selvage-tetgen");
  EXPECT_TRUE(program.ok());
  Result<TetMesh> mesh = run_tetgen(*program, {.points = surface.points, .triangles = surface.triangles}, {});
  EXPECT_TRUE(mesh.ok()) << (mesh.ok() ? "" : to_string(mesh.error()));
  if (!mesh) return result;
  result.mesh = std::move(*mesh);
  std::vector<std::uint32_t> regions(result.mesh.cells.size(), 0);
  improve(result.mesh.points, result.mesh.cells, regions, surface.points.size(),
          {.target = 10, .refine = RefineOptions{}});
  for (std::size_t p = 0; p < result.mesh.points.size(); ++p)
    result.yarns.push_back(p >= surface.points.size()              ? no_yarn
                           : result.mesh.points[p].z() < 0.5 * gap ? 0
                                                                   : 1);
  return result;
}

class Gap : public testing::TestWithParam<double> {};

TEST_P(Gap, IsFilledByBothYarns) {
  constexpr double radius = 12, gap = 1;
  Slab between = slab(radius, gap, GetParam());
  std::vector<std::uint32_t> regions(between.mesh.cells.size(), 2);
  const Bonding bonding =
      bond_contacts(between.mesh.points, between.mesh.cells, between.yarns, 2, 1.01 * gap, regions);
  const double area = std::numbers::pi * radius * radius;
  EXPECT_EQ(bonding.cells, regions.size());
  EXPECT_NEAR(bonding.volume, area * gap, 0.02 * area);  // the disc is a polygon
  // The shared faces run up and down through the gap.
  EXPECT_GT(bonding.area, 0.9 * area);
  EXPECT_LT(bonding.area, 2.7 * area);
  const auto lower = std::count(regions.begin(), regions.end(), 0U);
  EXPECT_GT(lower, static_cast<std::ptrdiff_t>(regions.size() / 4));
  EXPECT_LT(lower, static_cast<std::ptrdiff_t>(3 * regions.size() / 4));
}

INSTANTIATE_TEST_SUITE_P(Edges, Gap, testing::Values(1.0, 2.0, 3.0));

TEST(Bond, WiderGapsStayMatrix) {
  Slab between = slab(12, 1, 2);
  std::vector<std::uint32_t> regions(between.mesh.cells.size(), 2);
  const Bonding bonding =
      bond_contacts(between.mesh.points, between.mesh.cells, between.yarns, 2, 0.3, regions);
  EXPECT_EQ(bonding.cells, 0U);
  EXPECT_EQ(bonding.area, 0);
}

TEST(Bond, OneYarnAloneStays) {
  Slab between = slab(12, 1, 2);
  std::vector<std::uint32_t> regions(between.mesh.cells.size(), 2);
  for (std::uint32_t& yarn : between.yarns)
    if (yarn != no_yarn) yarn = 0;
  EXPECT_EQ(bond_contacts(between.mesh.points, between.mesh.cells, between.yarns, 2, 2, regions).cells, 0U);
}

// A cell by itself, one corner over a face: it goes to the yarn of the face.
TEST(Bond, TheYarnWithMoreCornersGetsIt) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 0.2}};
  const std::vector<std::array<std::uint32_t, 4>> cells = {{0, 1, 2, 3}};
  std::vector<std::uint32_t> regions = {9};
  EXPECT_EQ(bond_contacts(points, cells, std::vector<std::uint32_t>{5, 5, 5, 4}, 9, 0.19, regions).cells, 0U);
  EXPECT_EQ(bond_contacts(points, cells, std::vector<std::uint32_t>{5, 5, 5, 4}, 9, 0.21, regions).cells, 1U);
  EXPECT_EQ(regions, (std::vector<std::uint32_t>{5}));
}

}  // namespace
}  // namespace selvage::fem
