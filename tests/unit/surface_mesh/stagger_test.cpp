// Points over a gap against what a lattice allows, by their places alone.
#include "surface_mesh/stagger.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "unit/surface_mesh/plane.h"

namespace selvage::fem {
namespace {

using test::Plane;

constexpr double edge_length = 0.1;

// The square of side 2 with its border divided in `pieces` a side: other pieces, another mesh.
TriangleMesh square(const Plane& plane, const SizeField& field, int pieces) {
  const std::array<Vec2, 4> corners = {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1), Vec2(-1, 1)};
  PlanarRegion region;
  for (std::size_t i = 0; i < 4; ++i)
    for (int k = 0; k < pieces; ++k) {
      const Vec2 q = corners[i] + (corners[(i + 1) % 4] - corners[i]) * k / pieces;
      region.add({plane.point(q), q});
    }
  region.close(0);
  Result<TriangleMesh> mesh = fill(region, plane, field);
  if (mesh) return std::move(*mesh);
  ADD_FAILURE() << to_string(mesh.error());
  return {};
}

// Of the points well inside: the share that has one of the other mesh nearer than a quarter of an
// edge, seen across the gap.
double share_over_points(const TriangleMesh& mesh, const TriangleMesh& other) {
  int all = 0, over = 0;
  for (const Vec3& p : mesh.points) {
    if (p.head<2>().cwiseAbs().maxCoeff() > 0.8) continue;
    ++all;
    over += std::any_of(other.points.begin(), other.points.end(),
                        [&](const Vec3& q) { return (p - q).head<2>().norm() < edge_length / 4; });
  }
  EXPECT_GT(all, 200);
  return static_cast<double>(over) / all;
}

double least_angle(const TriangleMesh& mesh) {
  double least = 180;
  for (const auto& t : mesh.triangles)
    least = std::min(least, smallest_angle(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]));
  return least;
}

struct Pair {
  Plane low, high;
  SizeField field{edge_length, 0.3, {}};
  TriangleMesh below, above;
  explicit Pair(double gap)
      : low(0), high(gap), below(square(low, field, 20)), above(square(high, field, 19)) {}
  void run(int threads) {
    stagger(std::array{StaggeredMesh{&below, &low}, StaggeredMesh{&above, &high}}, field, threads);
  }
};

// Meshes that know nothing of each other have as many points over points as areas have it: pi / 16 over the
// root of 3/4, 23 %.
TEST(Stagger, PointsAreNotOverPoints) {
  Pair pair(edge_length / 4);
  const TriangleMesh before = pair.below;
  EXPECT_NEAR(share_over_points(pair.below, pair.above), 0.227, 0.06);
  pair.run(1);
  EXPECT_LT(share_over_points(pair.below, pair.above), 0.03);
  EXPECT_LT(share_over_points(pair.above, pair.below), 0.03);
  EXPECT_GE(least_angle(pair.below), std::min(25.0, least_angle(before)));
  ASSERT_EQ(pair.below.points.size(), before.points.size());
  EXPECT_EQ(pair.below.triangles.size(), before.triangles.size());
  double area = 0;
  for (const auto& t : pair.below.triangles) {
    const Vec3& a = pair.below.points[t[0]];
    area += (pair.below.points[t[1]] - a).cross(pair.below.points[t[2]] - a).z() / 2;
  }
  EXPECT_NEAR(area, 4, 1e-12);
  for (std::size_t k = 0; k < before.fixed_points; ++k) EXPECT_EQ(pair.below.points[k], before.points[k]);
}

TEST(Stagger, SameWithAnyThreads) {
  Pair one(edge_length / 4), two(edge_length / 4);
  one.run(1);
  two.run(2);
  EXPECT_EQ(one.below.points, two.below.points);
  EXPECT_EQ(one.above.triangles, two.above.triangles);
}

TEST(Stagger, WideGapsAreLeftAlone) {
  Pair pair(2 * edge_length);
  const std::vector<Vec3> before = pair.below.points;
  pair.run(1);
  EXPECT_EQ(pair.below.points, before);
}

}  // namespace
}  // namespace selvage::fem
