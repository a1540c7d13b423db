#include "surface_mesh/skin.h"

#include "tetrahedra/mesh_check.h"
#include "unit/fem/bodies.h"

namespace selvage::fem {
namespace {

using test::grid_body;
using test::straight_tube;

using Part = CellTriangles::Part;

// Divergence theorem about the first point.
double enclosed_volume(const Skin& skin) {
  const std::vector<Vec3>& points = skin.nodes.points;
  double sum = 0;
  for (const Triangle& t : skin.surface.triangles)
    sum += (points[t[0]] - points[0]).dot((points[t[1]] - points[0]).cross(points[t[2]] - points[0]));
  return sum / 6;
}

// Closed, and every point of the side where its parameters say.
Skin expect_sound(const yarn::Body& body, double size) {
  Result<Skin> skin = make_skin(body, size);
  if (!skin) {
    ADD_FAILURE() << body.name << ": " << to_string(skin.error());
    return {};
  }
  const Status closed = check_surface(skin->nodes.points, skin->surface.triangles, skin->surface.sides);
  EXPECT_TRUE(closed.ok()) << body.name << ": " << (closed.ok() ? "" : closed.error().text);
  EXPECT_GT(enclosed_volume(*skin), 0);
  EXPECT_NEAR(skin->volumes.front(), body.volume, 1e-7 * body.volume) << body.name;
  for (std::size_t k = 0; k < skin->nodes.points.size(); ++k) {
    const SurfacePlace& place = skin->nodes.places[k];
    if (place.body == no_body) continue;
    const Vec3 exact = nurbs::evaluate(body.surface, place.parameters.x(), place.parameters.y());
    EXPECT_LT((exact - skin->nodes.points[k]).norm(), 1e-9);
  }
  return std::move(*skin);
}

std::vector<Triangle> triangles_of(const Skin& skin, Part part) {
  std::vector<Triangle> result;
  for (std::size_t k = 0; k < skin.surface.triangles.size(); ++k)
    if (skin.surface.parts[k] == part) result.push_back(skin.surface.triangles[k]);
  return result;
}

std::vector<double> edges_of(const Skin& skin) {
  std::vector<double> result;
  for (const Triangle& t : skin.surface.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      result.push_back((skin.nodes.points[t[k]] - skin.nodes.points[t[(k + 1) % 3]]).norm());
  return result;
}

TEST(Skin, EdgesAreAboutTheWantedSize) {
  const Skin skin = expect_sound(straight_tube(1, 1, 5), 0.1);
  const std::vector<double> edges = edges_of(skin);
  double sum = 0;
  for (const double edge : edges) sum += edge;
  EXPECT_NEAR(sum / static_cast<double>(edges.size()), 0.09, 0.015);
  EXPECT_LT(*std::max_element(edges.begin(), edges.end()), 0.16);
}

TEST(Skin, FlatSectionIsFinerAtItsTips) {
  const Skin skin = expect_sound(straight_tube(0.8, 0.2, 2), 0.05);
  const std::vector<double> edges = edges_of(skin);
  const auto [shortest, longest] = std::minmax_element(edges.begin(), edges.end());
  EXPECT_LT(*shortest, 0.6 * *longest);
  EXPECT_GT(*shortest, 0.1 * *longest);
}

TEST(Skin, ManyShapes) {
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
  const Skin skin = expect_sound(ring, 0.2);
  EXPECT_EQ(triangles_of(skin, Part::side).size(), skin.surface.triangles.size());
  // V - E + F of a torus.
  EXPECT_EQ(skin.nodes.points.size(), skin.surface.triangles.size() / 2);
}

TEST(Skin, YarnThatRunsInsideOut) {
  const yarn::Body body = grid_body("inside out", 16, 8, [](double a, double s) {
    return Vec3(3 * s, 0.5 * std::cos(a), -0.5 * std::sin(a));
  });
  EXPECT_TRUE(body.inward);
  expect_sound(body, 0.2);
}

TEST(Skin, NonConvexSectionAndBentEnd) {
  const yarn::Body body = grid_body("kidney", 24, 8, [](double a, double s) {
    const double r = 0.5 * (1 - 0.6 * std::pow(std::max(0.0, std::sin(a)), 2));
    return Vec3(3 * s + 0.1 * std::cos(2 * a), r * std::cos(a), r * std::sin(a));
  });
  const Skin skin = expect_sound(body, 0.1);
  ASSERT_EQ(skin.surface.caps.size(), 2U);
  for (const CellTriangles::Cap& cap : skin.surface.caps) EXPECT_FALSE(cap.shape.is_flat());
  // Points inside the cap lie on the end patch.
  ASSERT_EQ(body.end.style, yarn::EndStyle::patch);
  for (const Triangle& t : triangles_of(skin, Part::end)) {
    double nearest = 1;
    for (int i = 0; i <= 200; ++i)
      for (int j = 0; j <= 200; ++j)
        nearest = std::min(
            nearest,
            (nurbs::evaluate(body.end.surface, i / 200.0, j / 200.0) - skin.nodes.points[t[0]]).norm());
    EXPECT_LT(nearest, 0.006);
  }
}

TEST(Skin, SharpCrestsGetVertices) {
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
  const Skin skin = expect_sound(body, 0.13);
  EXPECT_NEAR(enclosed_volume(skin), 1.5, 1e-12);
}

}  // namespace
}  // namespace selvage::fem
