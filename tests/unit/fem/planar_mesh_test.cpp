#include "fem/planar_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace selvage::fem {
namespace {

double area(const Vec2& a, const Vec2& b, const Vec2& c) {
  return ((b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x())) / 2;
}

double area(const std::vector<Vec2>& polygon) {
  double sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    sum += area(Vec2(0, 0), polygon[i], polygon[(i + 1) % polygon.size()]);
  return sum;
}

// Straight sides between the corners, `pieces` edges each.
std::vector<Vec2> divided(const std::vector<Vec2>& corners, int pieces) {
  std::vector<Vec2> result;
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (int k = 0; k < pieces; ++k)
      result.push_back(corners[i] + (corners[(i + 1) % corners.size()] - corners[i]) * k / pieces);
  return result;
}

std::vector<Vec2> ellipse(double a, double b, int count) {
  std::vector<Vec2> result;
  for (int i = 0; i < count; ++i)
    result.emplace_back(a * std::cos(2 * std::numbers::pi * i / count),
                        b * std::sin(2 * std::numbers::pi * i / count));
  return result;
}

// Every triangle counter-clockwise, every edge inside shared by two, the rim's edges exactly the polygon's,
// the area the polygon's, and no point inside the circle of a neighbour that the edge between could be turned
// for.
void expect_sound(const std::vector<Vec2>& rim, const PlanarMesh& mesh) {
  ASSERT_GE(mesh.points.size(), rim.size());
  EXPECT_TRUE(std::equal(rim.begin(), rim.end(), mesh.points.begin()));
  double sum = 0;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> opposite;
  for (const auto& t : mesh.triangles) {
    const double part = area(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]);
    EXPECT_GT(part, 0);
    sum += part;
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_TRUE(opposite.emplace(std::pair(t[k], t[(k + 1) % 3]), t[(k + 2) % 3]).second);
  }
  EXPECT_NEAR(sum, area(rim), 1e-12 * area(rim));
  std::size_t on_rim = 0;
  for (const auto& [edge, apex] : opposite) {
    const auto other = opposite.find({edge.second, edge.first});
    if (other == opposite.end()) {
      EXPECT_EQ(edge.second, (edge.first + 1) % rim.size());
      ++on_rim;
      continue;
    }
    const Vec2 &a = mesh.points[edge.first], &b = mesh.points[edge.second], &c = mesh.points[apex];
    const Vec2& d = mesh.points[other->second];
    // Angles opposite to an edge of a Delaunay triangulation are at most pi together.
    auto angle = [](const Vec2& at, const Vec2& p, const Vec2& q) {
      return std::acos(std::clamp((p - at).normalized().dot((q - at).normalized()), -1.0, 1.0));
    };
    EXPECT_LT(angle(c, a, b) + angle(d, a, b), std::numbers::pi + 1e-6);
  }
  EXPECT_EQ(on_rim, rim.size());
}

TEST(PlanarMesh, SquareWithStraightSides) {
  const std::vector<Vec2> rim = divided({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 8);
  const auto mesh = mesh_polygon(rim, 0.125);
  ASSERT_TRUE(mesh);
  expect_sound(rim, *mesh);
  EXPECT_GT(mesh->points.size(), rim.size() + 30);
}

TEST(PlanarMesh, FlatEllipseWithoutInnerPoints) {
  const std::vector<Vec2> rim = ellipse(4, 0.2, 40);
  const auto mesh = mesh_polygon(rim, 1);
  ASSERT_TRUE(mesh);
  expect_sound(rim, *mesh);
  EXPECT_EQ(mesh->points.size(), rim.size());
  EXPECT_EQ(mesh->triangles.size(), rim.size() - 2);
}

TEST(PlanarMesh, FarFromTheOrigin) {
  std::vector<Vec2> rim = ellipse(0.4, 0.1, 48);
  for (Vec2& point : rim) point += Vec2(4096, -2048);
  const auto mesh = mesh_polygon(rim, 0.05);
  ASSERT_TRUE(mesh);
  EXPECT_GT(mesh->points.size(), rim.size());
  for (const auto& t : mesh->triangles)
    EXPECT_GT(area(mesh->points[t[0]], mesh->points[t[1]], mesh->points[t[2]]), 0);
}

TEST(PlanarMesh, NonConvexShapes) {
  const std::vector<Vec2> comb = {{0, 0}, {7, 0}, {7, 3}, {6, 3}, {6, 1}, {5, 1}, {5, 3}, {4, 3},
                                  {4, 1}, {3, 1}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};
  std::vector<Vec2> kidney;
  for (int i = 0; i < 60; ++i) {
    const double angle = 2 * std::numbers::pi * i / 60;
    const double radius = 1 - 0.7 * std::pow(std::max(0.0, std::sin(angle)), 4);
    kidney.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  for (const std::vector<Vec2>& rim : {divided(comb, 3), kidney}) {
    const auto mesh = mesh_polygon(rim, 0.15);
    ASSERT_TRUE(mesh);
    expect_sound(rim, *mesh);
  }
}

TEST(PlanarMesh, RefusesWhatIsNoPolygon) {
  EXPECT_FALSE(mesh_polygon(std::vector<Vec2>{{0, 0}, {1, 0}}, 1));
  EXPECT_FALSE(mesh_polygon(std::vector<Vec2>{{0, 0}, {1, 0}, {2, 0}}, 1));          // encloses nothing
  EXPECT_FALSE(mesh_polygon(std::vector<Vec2>{{0, 0}, {0, 1}, {1, 1}, {1, 0}}, 1));  // runs the other way
}

}  // namespace
}  // namespace selvage::fem
