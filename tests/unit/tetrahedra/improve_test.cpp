#include "tetrahedra/improve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

#include "core/module.h"
#include "fem/quality.h"
#include "surface_mesh/skin.h"
#include "tetrahedra/worker.h"
#include "unit/fem/bodies.h"
#include "unit/tetrahedra/plates.h"

namespace selvage::fem {
namespace {

using Cell = std::array<std::uint32_t, 4>;

struct Tets {
  std::vector<Vec3> points;
  std::vector<Cell> cells;
  std::vector<std::uint32_t> regions;
  std::size_t fixed = 0;
};

// Its corners may not move.
Tets one_tet(const std::array<Vec3, 4>& corners) {
  return {{corners.begin(), corners.end()}, {{0, 1, 2, 3}}, {0}, 4};
}

ElementShape shape(const Tets& tets, const Cell& cell) {
  return shape_of({tets.points[cell[0]], tets.points[cell[1]], tets.points[cell[2]], tets.points[cell[3]]});
}

double least_angle(const Tets& tets) {
  double least = 180;
  for (const Cell& cell : tets.cells) least = std::min(least, shape(tets, cell).min_dihedral);
  return least;
}

// Triangles that only one cell of their region has, with the region, increasing.
std::vector<std::array<std::uint32_t, 4>> walls(const Tets& tets) {
  std::map<std::array<std::uint32_t, 4>, int> count;
  for (std::size_t c = 0; c < tets.cells.size(); ++c)
    for (std::size_t k = 0; k < 4; ++k) {
      std::array<std::uint32_t, 4> side{};
      for (std::size_t j = 0, n = 0; j < 4; ++j)
        if (j != k) side[n++] = tets.cells[c][j];
      std::sort(side.begin(), side.begin() + 3);
      side[3] = tets.regions[c];
      ++count[side];
    }
  std::vector<std::array<std::uint32_t, 4>> result;
  for (const auto& [side, times] : count) {
    EXPECT_LE(times, 2);
    if (times == 1) result.push_back(side);
  }
  return result;
}

std::map<std::uint32_t, double> volumes(const Tets& tets) {
  std::map<std::uint32_t, double> result;
  for (std::size_t c = 0; c < tets.cells.size(); ++c) {
    const Cell& t = tets.cells[c];
    const Vec3& o = tets.points[t[0]];
    const double six = (tets.points[t[1]] - o).cross(tets.points[t[2]] - o).dot(tets.points[t[3]] - o);
    EXPECT_GE(six, 0);
    result[tets.regions[c]] += six / 6;
  }
  return result;
}

// Improves it and checks what must hold whatever the mesh.
Improvement improved(Tets& tets, double target) {
  const Tets before = tets;
  Improvement result = improve(tets.points, tets.cells, tets.regions, tets.fixed, {.target = target});
  EXPECT_GE(least_angle(tets), least_angle(before) - 1e-9);
  EXPECT_GT(least_angle(tets), 0);
  EXPECT_GE(tets.points.size(), tets.fixed);
  for (std::size_t p = 0; p < std::min(tets.fixed, tets.points.size()); ++p)
    EXPECT_EQ(tets.points[p], before.points[p]);
  EXPECT_EQ(walls(tets), walls(before));
  const auto old_volumes = volumes(before), new_volumes = volumes(tets);
  EXPECT_EQ(old_volumes.size(), new_volumes.size());
  for (const auto& [region, volume] : old_volumes)
    EXPECT_NEAR(new_volumes.at(region), volume, 1e-11 * volume) << region;
  const auto below = std::count_if(tets.cells.begin(), tets.cells.end(), [&](const Cell& cell) {
    return shape(tets, cell).min_dihedral < target - 1e-9;
  });
  EXPECT_EQ(static_cast<std::size_t>(below), result.below.size());
  Tets again = before;
  improve(again.points, again.cells, again.regions, again.fixed, {.target = target});
  EXPECT_EQ(again.cells, tets.cells);
  EXPECT_EQ(again.points, tets.points);
  return result;
}

// n^3 cubes of six tetrahedra each (Kuhn), two regions: x below and above the middle. Inner points are moved
// by up to `shake` of an edge along each axis, where every cell at them stays positive.
Tets shaken_cubes(std::uint32_t n, double shake) {
  Tets tets;
  const auto number = [n](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return x + (n + 1) * (y + (n + 1) * z);
  };
  for (std::uint32_t z = 0; z <= n; ++z)
    for (std::uint32_t y = 0; y <= n; ++y)
      for (std::uint32_t x = 0; x <= n; ++x) tets.points.emplace_back(x, y, z);
  std::vector<std::vector<std::size_t>> at(tets.points.size());
  for (std::uint32_t z = 0; z < n; ++z)
    for (std::uint32_t y = 0; y < n; ++y)
      for (std::uint32_t x = 0; x < n; ++x) {
        std::array<int, 3> axes = {0, 1, 2};
        do {
          std::array<std::uint32_t, 3> corner = {x, y, z};
          Cell cell{};
          for (std::size_t k = 0; k < 4; ++k) {
            cell[k] = number(corner[0], corner[1], corner[2]);
            if (k < 3) ++corner[static_cast<std::size_t>(axes[k])];
          }
          const bool odd =
              axes == std::array{0, 2, 1} || axes == std::array{1, 0, 2} || axes == std::array{2, 1, 0};
          if (odd) std::swap(cell[2], cell[3]);
          for (const std::uint32_t corner_number : cell) at[corner_number].push_back(tets.cells.size());
          tets.cells.push_back(cell);
          tets.regions.push_back(2 * x < n ? 7 : 3);
        } while (std::next_permutation(axes.begin(), axes.end()));
      }
  std::mt19937 random(1);
  const auto step = [&] { return shake * (2 * (static_cast<double>(random()) / 4294967296.0) - 1); };
  for (std::uint32_t z = 1; z < n; ++z)
    for (std::uint32_t y = 1; y < n; ++y)
      for (std::uint32_t x = 1; x < n; ++x) {
        if (2 * x == n) continue;
        const std::uint32_t p = number(x, y, z);
        const Vec3 old = tets.points[p];
        tets.points[p] += Vec3(step(), step(), step());
        const bool sound = std::all_of(at[p].begin(), at[p].end(), [&](std::size_t c) {
          return shape(tets, tets.cells[c]).scaled_jacobian > 0;
        });
        if (!sound) tets.points[p] = old;
      }
  return tets;
}

Tets tetgen_mesh(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  Result<TetMesh> mesh =
      run_tetgen(find_worker("selvage-tetgen").value(), {.points = points, .triangles = triangles}, {});
  if (!mesh) {
    ADD_FAILURE() << mesh.error().text;
    return {};
  }
  return {mesh->points, mesh->cells, std::vector<std::uint32_t>(mesh->cells.size(), 0), points.size()};
}

TEST(Improve, CubesWithShakenPoints) {
  Tets tets = shaken_cubes(8, 0.7);
  EXPECT_LT(least_angle(tets), 2);
  EXPECT_GT(std::ranges::count_if(tets.cells,
                                  [&](const Cell& cell) { return shape(tets, cell).min_dihedral < 20; }),
            300);
  const Improvement result = improved(tets, 20);
  EXPECT_GE(least_angle(tets), 20);
  EXPECT_TRUE(result.below.empty());
}

// A target that many stars cannot reach: nothing is made worse on the way to it.
TEST(Improve, NothingBecomesWorse) {
  Tets tets = shaken_cubes(5, 0.2);
  for (Vec3& point : tets.points) point.z() *= 0.1;
  const double before = least_angle(tets);
  improve(tets.points, tets.cells, tets.regions, tets.fixed, {.target = 30, .passes = 3});
  EXPECT_GE(least_angle(tets), before - 1e-9);
}

TEST(Improve, WhatIsGoodEnoughIsLeftAlone) {
  Tets tets = shaken_cubes(4, 0);
  const Tets before = tets;
  EXPECT_NEAR(least_angle(tets), 45, 1e-9);  // of Kuhn's tetrahedra
  improved(tets, 30);
  EXPECT_EQ(tets.cells, before.cells);
  EXPECT_EQ(tets.points, before.points);
}

// Points come in until the cells away from the walls are small; walls and volumes stay, and threads change
// nothing.
TEST(Improve, RegionsAreRefined) {
  const Tets before = shaken_cubes(6, 0.5);
  const double bound = 1.0 / 20;
  ImproveOptions options{.target = 12, .refine = RefineOptions{.max_volume = bound}};
  Tets tets = before;
  improve(tets.points, tets.cells, tets.regions, tets.fixed, options);
  EXPECT_GE(least_angle(tets), 12);
  EXPECT_EQ(walls(tets), walls(before));
  const auto old_volumes = volumes(before), new_volumes = volumes(tets);
  std::size_t inner = 0, large = 0;
  double slenderness = 0;  // mean square of the radius over the shortest edge; of a regular one 3/8
  for (const Cell& cell : tets.cells) {
    const Vec3& a = tets.points[cell[0]];
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k) edges.row(k) = tets.points[cell[static_cast<std::size_t>(k) + 1]] - a;
    const bool at_wall = std::any_of(cell.begin(), cell.end(), [&](std::uint32_t corner) {
      const Vec3& p = tets.points[corner];
      return (p.array() == 0 || p.array() == 6).any() || p.x() == 3;
    });
    inner += at_wall ? 0 : 1;
    large += !at_wall && edges.determinant() > 6 * bound ? 1 : 0;
    const Vec3 centre = edges.fullPivLu().solve(0.5 * edges.rowwise().squaredNorm());
    double shortest = edges.rowwise().squaredNorm().minCoeff();
    for (int k = 0; k < 3; ++k)
      shortest = std::min(shortest, (edges.row(k) - edges.row((k + 1) % 3)).squaredNorm());
    slenderness += centre.squaredNorm() / shortest / static_cast<double>(tets.cells.size());
  }
  for (const auto& [region, volume] : old_volumes)
    EXPECT_NEAR(new_volumes.at(region), volume, 1e-11 * volume) << region;
  EXPECT_GT(inner, 1000U);
  EXPECT_LT(large, inner / 25);  // exchanges may join some that were small enough
  EXPECT_LT(static_cast<double>(tets.cells.size()), 5 * 216 / bound);
  EXPECT_LT(slenderness, 1.4 * 1.4);
  for (const int threads : {2, 5}) {
    Tets again = before;
    options.threads = threads;
    improve(again.points, again.cells, again.regions, again.fixed, options);
    EXPECT_EQ(again.points, tets.points);
    EXPECT_EQ(again.cells, tets.cells);
    EXPECT_EQ(again.regions, tets.regions);
  }
}

// Cells that are anything but Delaunay, slender all, and a ratio that no refinement reaches: it ends, loses
// no point, and makes no edge shorter than the shortest one.
TEST(Improve, RefinementEnds) {
  const auto shortest = [](const Tets& tets) {
    double least = 1e9;
    for (const Cell& cell : tets.cells)
      for (std::size_t i = 1; i < 4; ++i)
        for (std::size_t j = 0; j < i; ++j)
          least = std::min(least, (tets.points[cell[i]] - tets.points[cell[j]]).norm());
    return least;
  };
  for (const double flat : {1.0, 0.3, 0.1}) {
    Tets before = shaken_cubes(8, 0.7);
    for (Vec3& point : before.points) point.z() *= flat;
    Tets tets = before;
    improve(tets.points, tets.cells, tets.regions, tets.fixed,
            {.polish = 0, .passes = 0, .refine = RefineOptions{.radius_edge = 1}});
    ASSERT_GT(tets.points.size(), before.points.size() + 100) << flat;
    EXPECT_TRUE(std::equal(before.points.begin(), before.points.end(), tets.points.begin()));
    EXPECT_GE(shortest(tets), shortest(before) * (1 - 1e-12));
    EXPECT_LT(tets.cells.size(), 50 * before.cells.size());
    EXPECT_EQ(walls(tets), walls(before));
    const auto old_volumes = volumes(before), new_volumes = volumes(tets);
    for (const auto& [region, volume] : old_volumes)
      EXPECT_NEAR(new_volumes.at(region), volume, 1e-11 * volume) << region;
    for (const Cell& cell : tets.cells) ASSERT_GT(shape(tets, cell).scaled_jacobian, 0);
  }
}

// Four points near a circle's plane, a quarter turn apart: TetGen's usual sliver. Above and below it the
// octahedron's two tips.
TEST(Improve, SliverInAnOctahedron) {
  Tets tets;
  tets.points = {{1, 0, 0.01}, {0, 1, -0.01}, {-1, 0, 0.01}, {0, -1, -0.01}, {0, 0, 1}, {0, 0, -1}};
  // The sliver's upper two sides and its lower two, each with a tip, and the sliver between them.
  tets.cells = {{0, 1, 2, 4}, {0, 2, 3, 4}, {0, 3, 1, 5}, {1, 3, 2, 5}, {0, 1, 2, 3}};
  tets.regions.assign(5, 0);
  tets.fixed = 6;
  for (Cell& cell : tets.cells)
    if (shape(tets, cell).scaled_jacobian < 0) std::swap(cell[2], cell[3]);
  EXPECT_LT(least_angle(tets), 2.5);
  improved(tets, 10);
  EXPECT_GT(least_angle(tets), 40);
}

// Near contact: with edges of up to four gaps TetGen's mesh comes to the target.
TEST(Improve, GapsBetweenPlates) {
  for (const double edge : {1.0, 2.0, 3.0, 4.0}) {
    const test::ClosedSurface surface = test::two_plates(12, 1, edge);
    Tets tets = tetgen_mesh(surface.points, surface.triangles);
    improved(tets, 10);
    EXPECT_GE(least_angle(tets), 10) << edge;
  }
}

// Where the surface is too coarse for its gap, the account says what it would have to be.
TEST(Improve, SurfaceTooCoarseForItsGap) {
  const test::ClosedSurface surface = test::two_plates(70, 1, 20);
  Tets tets = tetgen_mesh(surface.points, surface.triangles);
  const Improvement result = improved(tets, 10);
  ASSERT_FALSE(result.below.empty());
  for (const BelowTarget& below : result.below) {
    EXPECT_LT(below.angle, 10);
    if (below.cause != BelowTarget::Cause::surface) continue;
    EXPECT_GT(below.edge_needed, 0.5);
    EXPECT_LT(below.edge_needed, 3.01);  // three gaps
  }
  EXPECT_NEAR(result.below.front().angle, least_angle(tets), 1e-6);
}

TEST(Improve, WedgeOfTheGeometryIsNamed) {
  const double wedge = 4 * std::numbers::pi / 180;
  Tets tets = one_tet({{{0, 0, 0}, {0, 0, 1}, {1, 0, 0.5}, {std::cos(wedge), std::sin(wedge), 0.5}}});
  const Improvement result = improved(tets, 10);
  ASSERT_EQ(result.below.size(), 1U);
  EXPECT_EQ(result.below[0].cause, BelowTarget::Cause::geometry);
  EXPECT_NEAR(result.below[0].wedge, 4, 1e-9);
  EXPECT_NEAR(result.below[0].at.x(), 0, 1e-12);
}

TEST(Improve, WedgesAreToldInANote) {
  const double half = 2 * std::numbers::pi / 180;
  Tets tets = one_tet({{{0, 0, 0},
                        {std::cos(half), -std::sin(half), 0},
                        {std::cos(half), std::sin(half), 0},
                        {0.5, 0, 0.7}}});
  const Improvement result = improved(tets, 10);
  // Its edge to the top stands over a wedge of the geometry, 0-3 between the sides at the needle's tip.
  ASSERT_EQ(result.below.size(), 1U);
  EXPECT_EQ(result.below[0].cause, BelowTarget::Cause::geometry);
  const std::vector<Message> messages = describe(result, 10, "mm");
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].severity, Severity::note);
  EXPECT_EQ(count(result, 10).in_wedges, 1U);
}

// A cube with an edge that has a piece of a hundredth, and triangles on that.
TEST(Improve, NeedlesOfTheSurfaceAreNamed) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},   {0, 0, 1},
                                    {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.5, 0, 1}, {0.51, 0, 1}};
  const std::vector<Triangle> triangles = {{0, 2, 1}, {0, 3, 2}, {7, 4, 8}, {7, 8, 9}, {7, 9, 5}, {7, 5, 6},
                                           {0, 1, 5}, {0, 5, 9}, {0, 9, 8}, {0, 8, 4}, {1, 2, 6}, {1, 6, 5},
                                           {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
  Tets tets = tetgen_mesh(points, triangles);
  const Improvement result = improved(tets, 15);
  ASSERT_FALSE(result.below.empty());
  for (const BelowTarget& below : result.below) {
    EXPECT_EQ(below.cause, BelowTarget::Cause::needle) << below.angle;
    EXPECT_NEAR(below.wedge, 0.4, 0.15);  // a hundredth over the square root of two
  }
  const std::vector<Message> messages = describe(result, 15, "mm");
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].severity, Severity::warning);
  EXPECT_NE(messages[0].text.find("needles"), std::string::npos);
}

// An edge of the surface with more cells in it than its angle bears: it loses some.
TEST(Improve, EdgeOfTheSurfaceLosesCells) {
  Tets tets;
  tets.points = {{0, 0, 0}, {0, 0, 1}};
  for (int k = 0; k < 4; ++k) {
    const double angle = 7 * k * std::numbers::pi / 180;
    const double radius = k == 0 || k == 3 ? 1.0 : 0.8;
    tets.points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.5);
  }
  for (std::uint32_t k = 0; k < 3; ++k) tets.cells.push_back({0, 1, 2 + k, 3 + k});
  tets.regions.assign(3, 0);
  tets.fixed = 2;
  const double before = least_angle(tets);
  EXPECT_LT(before, 7.1);
  improved(tets, 12);
  EXPECT_GT(least_angle(tets), before);
}

TEST(Improve, YarnFromTetgen) {
  const yarn::Body body = test::straight_tube(1, 0.5, 3);
  const Result<Skin> skin = make_skin(body, 0.1);
  ASSERT_TRUE(skin.ok());
  Tets tets = tetgen_mesh(skin->nodes.points, skin->surface.triangles);
  EXPECT_LT(least_angle(tets), 18);
  improve(tets.points, tets.cells, tets.regions, tets.fixed,
          {.target = 18, .refine = RefineOptions{.max_volume = 0.00013}});
  EXPECT_GE(least_angle(tets), 18 - 1e-6);
}

}  // namespace
}  // namespace selvage::fem
