#include "fem/surface_mesh.h"

#include "fem/mesh_check.h"
#include "unit/fem/bodies.h"

namespace selvage::fem {
namespace {

using test::grid_body;
using test::straight_tube;

// Everything a TetGen job needs, and every point of the side where its parameters say.
SurfaceMesh expect_sound(const yarn::Body& body, double size) {
  Result<SurfaceMesh> mesh = mesh_surface(body, size);
  if (!mesh) {
    ADD_FAILURE() << body.name << ": " << mesh.error().text;
    return {};
  }
  const Status closed = check_surface(mesh->points, mesh->triangles);
  EXPECT_TRUE(closed.ok()) << body.name << ": " << (closed.ok() ? "" : closed.error().text);
  EXPECT_EQ(mesh->side_triangles + mesh->start_triangles + mesh->end_triangles, mesh->triangles.size());
  for (std::size_t i = 0; i < mesh->parameters.size(); ++i) {
    const Vec3 true_point = nurbs::evaluate(body.surface, mesh->parameters[i].x(), mesh->parameters[i].y());
    EXPECT_LT((true_point - mesh->points[i]).norm(), 1e-12);
  }
  return std::move(*mesh);
}

double flat_area(const SurfaceMesh& mesh, std::span<const Triangle> triangles) {
  double sum = 0;
  for (const Triangle& t : triangles)
    sum += (mesh.points[t[1]] - mesh.points[t[0]]).cross(mesh.points[t[2]] - mesh.points[t[0]]).norm() / 2;
  return sum;
}

TEST(SurfaceMesh, StraightYarnIsAPrism) {
  for (const double size : {0.5, 0.25, 0.1}) {
    const SurfaceMesh mesh = expect_sound(straight_tube(1, 0.6, 5), size);
    const double end = flat_area(mesh, mesh.end());
    EXPECT_NEAR(flat_area(mesh, mesh.start()), end, 1e-13);
    EXPECT_NEAR(enclosed_volume(mesh.points, mesh.triangles), 5 * end, 1e-12);
  }
}

TEST(SurfaceMesh, EdgesAreAboutTheWantedSize) {
  const SurfaceMesh mesh = expect_sound(straight_tube(1, 1, 5), 0.1);
  double sum = 0, longest = 0;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const double length = (mesh.points[t[k]] - mesh.points[t[(k + 1) % 3]]).norm();
      sum += length;
      longest = std::max(longest, length);
    }
  EXPECT_NEAR(sum / static_cast<double>(3 * mesh.triangles.size()), 0.11, 0.015);
  EXPECT_LT(longest, 0.16);  // the diagonals of the squares
}

TEST(SurfaceMesh, AtLeastEightRound) {
  const SurfaceMesh mesh = expect_sound(straight_tube(1, 1, 5), 100);
  std::size_t first_row = 0;
  while (mesh.parameters[first_row].y() == mesh.parameters[0].y()) ++first_row;
  EXPECT_GE(first_row, 8U);
  EXPECT_LT(mesh.coarsest, 0.5);
}

TEST(SurfaceMesh, FlatSectionIsFinerAtItsTips) {
  const SurfaceMesh mesh = expect_sound(straight_tube(0.8, 0.2, 2), 0.05);
  double shortest = 1, longest = 0;
  for (std::size_t i = 0; mesh.parameters[i + 1].y() == mesh.parameters[0].y(); ++i) {
    const double length = (mesh.points[i + 1] - mesh.points[i]).norm();
    shortest = std::min(shortest, length);
    longest = std::max(longest, length);
  }
  EXPECT_LT(shortest, 0.6 * longest);
  EXPECT_GT(shortest, 0.3 * longest);
}

TEST(SurfaceMesh, ManyShapes) {
  expect_sound(grid_body("wave", 16, 24,
                         [](double a, double s) {
                           return Vec3(4 * s, 0.4 * std::cos(a),
                                       0.15 * std::cos(12.566 * s) + 0.1 * std::sin(a));
                         }),
               0.05);
  expect_sound(grid_body("taper", 16, 8,
                         [](double a, double s) {
                           const double r = 0.5 - 0.45 * s;
                           return Vec3(3 * s, r * std::cos(a), r * std::sin(a));
                         }),
               0.1);
  expect_sound(grid_body("twisted", 16, 12,
                         [](double a, double s) {
                           const double turn = a + 6 * s;
                           const Vec2 p(0.5 * std::cos(a), 0.1 * std::sin(a));
                           const double c = std::cos(turn - a), n = std::sin(turn - a);
                           return Vec3(3 * s, c * p.x() - n * p.y(), n * p.x() + c * p.y());
                         }),
               0.08);
  const yarn::Body ring = grid_body(
      "ring", 16, 16,
      [](double a, double s) {
        const double r = 3 + 0.5 * std::cos(a), turn = 2 * std::numbers::pi * s;
        return Vec3(r * std::cos(turn), r * std::sin(turn), -0.5 * std::sin(a));
      },
      true);
  const SurfaceMesh mesh = expect_sound(ring, 0.2);
  EXPECT_EQ(mesh.start_triangles + mesh.end_triangles, 0U);
  // V - E + F of a torus.
  EXPECT_EQ(mesh.points.size(), mesh.triangles.size() / 2);
}

TEST(SurfaceMesh, YarnThatRunsInsideOut) {
  const yarn::Body body = grid_body("inside out", 16, 8, [](double a, double s) {
    return Vec3(3 * s, 0.5 * std::cos(a), -0.5 * std::sin(a));
  });
  EXPECT_TRUE(body.inward);
  expect_sound(body, 0.2);
}

TEST(SurfaceMesh, NonConvexSectionAndBentEnd) {
  const yarn::Body body = grid_body("kidney", 24, 8, [](double a, double s) {
    const double r = 0.5 * (1 - 0.6 * std::pow(std::max(0.0, std::sin(a)), 2));
    return Vec3(3 * s + 0.1 * std::cos(2 * a), r * std::cos(a), r * std::sin(a));
  });
  const SurfaceMesh mesh = expect_sound(body, 0.1);
  ASSERT_TRUE(mesh.end_cap);
  EXPECT_FALSE(mesh.end_cap->is_flat());
  // Points inside the cap lie on the end patch.
  ASSERT_EQ(body.end.style, yarn::EndStyle::patch);
  for (const std::uint32_t point : mesh.end_points) {
    double nearest = 1;
    for (int i = 0; i <= 200; ++i)
      for (int j = 0; j <= 200; ++j)
        nearest = std::min(
            nearest, (nurbs::evaluate(body.end.surface, i / 200.0, j / 200.0) - mesh.points[point]).norm());
    EXPECT_LT(nearest, 0.006);
  }
}

TEST(SurfaceMesh, SharpCrestsGetVertices) {
  yarn::GridNet net;
  net.sections = 4;
  net.per_section = 4;
  net.degree_round = 1;
  for (int j = 0; j < 4; ++j)
    for (const Vec2& corner : {Vec2(-0.5, -0.25), Vec2(0.5, -0.25), Vec2(0.5, 0.25), Vec2(-0.5, 0.25)})
      net.points.emplace_back(j, corner.x(), corner.y());
  yarn::Body body;
  body.name = "square";
  ASSERT_TRUE(yarn::fill_from_grid(body, net).ok());
  ASSERT_TRUE(yarn::finish(body, yarn::EndStyle::planar).ok());
  const SurfaceMesh mesh = expect_sound(body, 0.13);
  EXPECT_NEAR(enclosed_volume(mesh.points, mesh.triangles), 1.5, 1e-12);
}

TEST(SurfaceMesh, SmallestExtent) {
  EXPECT_NEAR(smallest_section_extent(straight_tube(0.8, 0.2, 2, 64)), 0.2, 0.002);
}

TEST(SurfaceMesh, Refusals) {
  yarn::Body body = straight_tube(1, 1, 5);
  EXPECT_EQ(mesh_surface(body, 0).error().kind, Kind::usage);
  EXPECT_EQ(mesh_surface(body, 1e-6).error().kind, Kind::limit);
  body.surface.points[7].y() = std::nan("");
  EXPECT_EQ(mesh_surface(body, 0.2).error().kind, Kind::geometry);
  EXPECT_EQ(mesh_surface({}, 0.2).error().kind, Kind::geometry);
}

}  // namespace
}  // namespace selvage::fem
