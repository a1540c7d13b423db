#include "surface_mesh/triangle_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "unit/surface_mesh/plane.h"

namespace selvage::fem {
namespace {

using test::Plane;

class Sphere final : public Support {
 public:
  [[nodiscard]] Vec3 point(const Vec2& p) const override {
    return {std::cos(p.x()) * std::cos(p.y()), std::sin(p.x()) * std::cos(p.y()), std::sin(p.y())};
  }
  [[nodiscard]] Vec3 normal(const Vec2& p) const override { return point(p); }
  [[nodiscard]] Place nearest(const Vec2& /*start*/, const Vec3& target) const override {
    const Vec3 n = target.normalized();
    return {{std::atan2(n.y(), n.x()), std::asin(n.z())}, n};
  }
};

struct Figures {
  std::map<std::int32_t, double> area;
  double least_angle = 180, longest = 0, shortest = 1e9;
};

Figures figures_of(const TriangleMesh& mesh, const SizeField& field) {
  Figures f;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const auto& t = mesh.triangles[k];
    const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
    f.area[mesh.domains[k]] += (b - a).cross(c - a).norm() / 2;
    f.least_angle = std::min(f.least_angle, smallest_angle(a, b, c));
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 &p = mesh.points[t[i]], &q = mesh.points[t[(i + 1) % 3]];
      const double ratio = (p - q).norm() / field.at((p + q) / 2);
      f.longest = std::max(f.longest, ratio);
      f.shortest = std::min(f.shortest, ratio);
    }
  }
  return f;
}

// Each edge belongs to two triangles that run along it both ways, but for those of the outer border.
void expect_whole(const TriangleMesh& mesh, std::size_t border_edges) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(++uses[std::pair(t[k], t[(k + 1) % 3])], 1);
  std::size_t open = 0;
  for (const auto& [edge, count] : uses) open += uses.contains(std::pair(edge.second, edge.first)) ? 0 : 1;
  EXPECT_EQ(open, border_edges);
}

void add_loop(PlanarRegion& region, const Support& support, const std::vector<Vec2>& loop, std::int32_t left,
              std::int32_t right) {
  const auto first = static_cast<std::uint32_t>(region.places.size());
  for (const Vec2& q : loop) region.add({support.point(q), q});
  region.close(first, left, right);
}

std::vector<Vec2> square(double half, int pieces) {
  std::vector<Vec2> result;
  const std::array<Vec2, 4> corners = {Vec2(-half, -half), Vec2(half, -half), Vec2(half, half),
                                       Vec2(-half, half)};
  for (std::size_t i = 0; i < 4; ++i)
    for (int k = 0; k < pieces; ++k)
      result.emplace_back(corners[i] + (corners[(i + 1) % 4] - corners[i]) * k / pieces);
  return result;
}

std::vector<Vec2> circle(double radius, int count) {
  std::vector<Vec2> result;
  for (int k = 0; k < count; ++k) {
    const double a = 2 * std::numbers::pi * k / count;
    result.emplace_back(radius * std::cos(a), radius * std::sin(a));
  }
  return result;
}

// A fine disc in a coarse square.
TEST(TriangleMesh, GradedPlaneWithTwoDomains) {
  const Plane plane;
  const SizeField field(0.2, 0.3, {{Vec3(0, 0, 0.25), 0.02}});
  PlanarRegion region;
  add_loop(region, plane, square(1, 10), 0, -1);
  add_loop(region, plane, circle(0.5, 24), 1, 0);
  Result<TriangleMesh> mesh = fill(region, plane, field);
  ASSERT_TRUE(mesh.ok()) << to_string(mesh.error());
  expect_whole(*mesh, 40);
  const Figures f = figures_of(*mesh, field);
  const double disc = 12 * std::sin(2 * std::numbers::pi / 24) * 0.25;
  EXPECT_NEAR(f.area.at(1), disc, 1e-12);
  EXPECT_NEAR(f.area.at(0), 4 - disc, 1e-12);
  EXPECT_GT(f.least_angle, 28);
  EXPECT_LT(f.longest, 1.6);
  EXPECT_GT(f.shortest, 0.5);
  EXPECT_GT(mesh->triangles.size(), 400);
  for (std::size_t k = 0; k < region.nodes.size(); ++k) EXPECT_EQ(mesh->points[k], region.nodes[k].point);
}

// A zone of the unit sphere between two latitudes: points on it, its area nearly the zone's.
TEST(TriangleMesh, PatchOfASphere) {
  const Sphere sphere;
  const SizeField field(0.1, 0.3, {});
  PlanarRegion region;
  std::vector<Vec2> loop = square(0.6, 12);
  add_loop(region, sphere, loop, 0, -1);
  Result<TriangleMesh> mesh = fill(region, sphere, field);
  ASSERT_TRUE(mesh.ok());
  expect_whole(*mesh, 48);
  const Figures f = figures_of(*mesh, field);
  const double exact = 1.2 * 2 * std::sin(0.6);
  EXPECT_NEAR(f.area.at(0), exact, 4e-3 * exact);
  EXPECT_GT(f.least_angle, 28);
  for (const Vec3& p : mesh->points) EXPECT_NEAR(p.norm(), 1, 1e-12);
}

TEST(TriangleMesh, SmallestAngle) {
  EXPECT_NEAR(smallest_angle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), 45, 1e-12);
  EXPECT_NEAR(smallest_angle({0, 0, 0}, {1, 0, 0}, {0.5, 0, std::sqrt(0.75)}), 60, 1e-12);
  EXPECT_EQ(smallest_angle({0, 0, 0}, {0, 0, 0}, {0, 1, 0}), 0);
}

TEST(SizeField, SmallestBoundAndGrowth) {
  const SizeField field(1, 0.5, {{Vec3(0, 0, 0), 0.1}, {Vec3(1, 0, 0), 0.3}, {Vec3(5, 5, 5), 2}});
  EXPECT_DOUBLE_EQ(field.at({0, 0, 0}), 0.1);
  EXPECT_DOUBLE_EQ(field.at({0.2, 0, 0}), 0.2);
  EXPECT_DOUBLE_EQ(field.at({1, 0, 0}), 0.3);
  EXPECT_DOUBLE_EQ(field.at({0, 9, 0}), 1);
}

// The borders of domains are what is said, or it is an error with the place.
TEST(Planar, RefusesCrossingLines) {
  const std::vector<Vec2> points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  const std::vector<solid::PlanarSegment> bow = {{0, 1, 0, -1}, {1, 3, 0, -1}, {3, 2, 0, -1}, {2, 0, 0, -1}};
  const Result<solid::PlanarTriangles> crossed = solid::triangulate(points, bow);
  ASSERT_FALSE(crossed.ok());
  EXPECT_EQ(crossed.error().kind, Kind::geometry);
  EXPECT_TRUE(crossed.error().at.has_value());
  const std::vector<Vec2> twice = {{0, 0}, {1, 0}, {1, 1}, {0, 0}};
  EXPECT_FALSE(solid::triangulate(twice, std::vector<solid::PlanarSegment>{}).ok());
  const std::vector<solid::PlanarSegment> open = {{0, 1, 0, -1}, {1, 2, 0, -1}};
  EXPECT_FALSE(solid::triangulate(points, open).ok());
}

}  // namespace
}  // namespace selvage::fem
