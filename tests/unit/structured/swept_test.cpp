#include "structured/swept.h"

#include <algorithm>
#include <cmath>

#include "fem/hexahedron.h"
#include "fem/sides.h"
#include "structured/beams.h"
#include "structured/section_pattern.h"
#include "unit/fem/bodies.h"

namespace selvage::fem {
namespace {

using test::grid_body;
using test::straight_tube;

Mesh mesh_of(const std::vector<yarn::Body>& bodies, const SweptOptions& options = {}) {
  Diagnostics diagnostics;
  Result<Mesh> mesh = mesh_swept({}, bodies, Unit::mm, options, diagnostics);
  if (!mesh) {
    ADD_FAILURE() << to_string(mesh.error());
    return {};
  }
  return std::move(*mesh);
}

EightNodes cube() {
  return {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0),
          Vec3(0, 0, 1), Vec3(1, 0, 1), Vec3(1, 1, 1), Vec3(0, 1, 1)};
}

TEST(Hexahedron, CubeShearedAndTurned) {
  EightNodes nodes = cube();
  ElementShape shape = shape_of_hexahedron(nodes, false);
  EXPECT_NEAR(shape.scaled_jacobian, 1, 1e-14);
  EXPECT_NEAR(shape.min_dihedral, 90, 1e-12);
  EXPECT_NEAR(shape.aspect, 1, 1e-14);
  for (Vec3& p : nodes) p.x() += p.y();  // by 45 degrees: the volume stays, one angle halves
  shape = shape_of_hexahedron(nodes, false);
  EXPECT_NEAR(volume_of_hexahedron(nodes), 1, 1e-14);
  EXPECT_NEAR(shape.scaled_jacobian, std::sqrt(0.5), 1e-14);
  EXPECT_NEAR(shape.min_dihedral, 45, 1e-12);
  EXPECT_NEAR(shape.max_dihedral, 135, 1e-12);
  std::swap(nodes[1], nodes[3]);
  std::swap(nodes[5], nodes[7]);
  EXPECT_LT(shape_of_hexahedron(nodes, false).scaled_jacobian, 0);
  EXPECT_NEAR(volume_of_hexahedron(nodes), -1, 1e-14);
}

// x' = x (1 + z): its determinant is 1 + z, the volume 1.5.
TEST(Hexahedron, VolumeOfAFrustum) {
  EightNodes nodes = cube();
  for (Vec3& p : nodes) p.x() *= 1 + p.z();
  EXPECT_NEAR(volume_of_hexahedron(nodes), 1.5, 1e-14);
}

TEST(Hexahedron, RegularWedge) {
  const double h = std::sqrt(0.75);
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0.5, h, 0), up(0, 0, 1);
  const EightNodes nodes = {a, b, c, c, a + up, b + up, c + up, c + up};
  const ElementShape shape = shape_of_hexahedron(nodes, true);
  EXPECT_NEAR(shape.scaled_jacobian, 1, 1e-14);
  EXPECT_NEAR(shape.min_dihedral, 60, 1e-12);
  EXPECT_NEAR(shape.max_dihedral, 90, 1e-12);
  EXPECT_NEAR(volume_of_hexahedron(nodes), h / 2, 1e-14);
}

// Affine images of the outline give the affine image of the inside.
TEST(SectionPattern, InsideFollowsTheOutline) {
  const yarn::Body body = straight_tube(1, 0.8, 3);
  const SectionPattern pattern = section_pattern(body, 0.25);
  std::vector<Vec3> outline = nurbs::evaluate_grid(body.surface, pattern.ring, {0.5});
  const std::vector<Vec3> inside = pattern.fill(outline);
  const auto moved = [](const Vec3& p) { return Vec3(p.x() + 2 * p.y(), 3 * p.y() - 1, p.z() + p.x()); };
  for (Vec3& point : outline) point = moved(point);
  const std::vector<Vec3> after = pattern.fill(outline);
  ASSERT_FALSE(inside.empty());
  for (std::size_t k = 0; k < inside.size(); ++k) EXPECT_LT((after[k] - moved(inside[k])).norm(), 1e-12);
}

TEST(Swept, StraightTubeHasItsVolumeAndEnds) {
  const Mesh mesh = mesh_of({straight_tube(1, 1, 5)});
  const Region& region = mesh.regions.front();
  EXPECT_EQ(mesh.shape, Mesh::Shape::hexahedron);
  EXPECT_NEAR(region.volume, region.exact_volume, 1e-3 * region.exact_volume);
  EXPECT_GT(mesh.quality.min_scaled_jacobian, 0.5);
  for (const std::size_t node : region.start_nodes) EXPECT_NEAR(mesh.nodes[node].x(), 0, 1e-9);
  for (const std::size_t node : region.end_nodes) EXPECT_NEAR(mesh.nodes[node].x(), 5, 1e-9);
  Vec3 whole = Vec3::Zero();
  double volume = 0;  // by the divergence of x / 3
  for (const auto* faces : {&region.side_faces, &region.start_faces, &region.end_faces})
    for (const ElementSide& face : *faces) {
      const Vec3 area = area_vector(mesh, face);
      whole += area;
      volume += area.dot(
          (mesh.nodes[face[0]] + mesh.nodes[face[1]] + mesh.nodes[face[2]] + mesh.nodes[face[3]]) / 12);
    }
  EXPECT_LT(whole.norm(), 1e-10);
  EXPECT_NEAR(volume, region.volume, 0.01 * region.volume);
}

// The faces that a region lists are those that no other element has.
TEST(Swept, FacesAreTheOuterSides) {
  const Mesh mesh = mesh_of({straight_tube(3, 0.3, 4), straight_tube(1, 1, 4, 24, Vec3(0, 0, 5))});
  std::size_t faces = 0;
  for (const Region& region : mesh.regions)
    faces += region.side_faces.size() + region.start_faces.size() + region.end_faces.size();
  EXPECT_EQ(outer_sides(mesh).size(), faces);
}

// Pappus: a ring's volume is its area times the way of its centre; rings have no ends.
TEST(Swept, RingCloses) {
  const yarn::Body ring = grid_body(
      "ring", 16, 16,
      [](double a, double s) {
        const double r = 3 + 0.5 * std::cos(a), turn = 2 * std::numbers::pi * s;
        return Vec3(r * std::cos(turn), r * std::sin(turn), -0.5 * std::sin(a));
      },
      true);
  const Mesh mesh = mesh_of({ring});
  EXPECT_TRUE(mesh.regions[0].start_nodes.empty());
  EXPECT_NEAR(mesh.regions[0].volume, ring.volume, 0.005 * ring.volume);
  EXPECT_EQ(outer_sides(mesh).size(), mesh.regions[0].side_faces.size());
}

// A grid whose control points run the other way round.
TEST(Swept, InwardSurfaceIsTurned) {
  const yarn::Body body = grid_body("turned", 16, 6, [](double a, double s) {
    return Vec3(4 * s, 0.5 * std::cos(-a), 0.4 * std::sin(-a));
  });
  ASSERT_TRUE(body.inward);
  const Mesh mesh = mesh_of({body});
  EXPECT_GT(mesh.quality.min_scaled_jacobian, 0);
  EXPECT_NEAR(mesh.regions[0].volume, body.volume, 0.005 * body.volume);
}

// A bend tighter than the yarn is thick has no sweep.
TEST(Swept, TightBendIsAnErrorThatNamesTheYarn) {
  const yarn::Body body = grid_body("hook", 16, 24, [](double a, double s) {
    const double turn = std::numbers::pi * s, r = 0.3 + 0.5 * std::cos(a);
    return Vec3(r * std::cos(turn), r * std::sin(turn), -0.5 * std::sin(a));
  });
  Diagnostics diagnostics;
  const std::vector<yarn::Body> bodies = {body};
  const Result<Mesh> mesh = mesh_swept({}, bodies, Unit::mm, {}, diagnostics);
  ASSERT_FALSE(mesh.ok());
  EXPECT_EQ(mesh.error().yarn, "hook");
  EXPECT_NE(mesh.error().text.find("--elements tet"), std::string::npos);
}

// The same bytes for any number of threads.
TEST(Swept, ThreadsDoNotMatter) {
  const std::vector<yarn::Body> bodies = {straight_tube(1, 0.5, 4),
                                          straight_tube(1, 0.5, 4, 24, Vec3(0, 0, 0.6))};
  const Mesh one = mesh_of(bodies, {.threads = 1}), two = mesh_of(bodies, {.threads = 2});
  EXPECT_EQ(one.nodes, two.nodes);
  EXPECT_EQ(one.elements, two.elements);
}

TEST(Beams, SectionOfAnEllipse) {
  const yarn::Body body = straight_tube(3, 0.6, 5, 96);
  const PlacedSection placed = beam_section(body, 0.4, 1);
  const double w = placed.section.width, h = placed.section.height, pi = std::numbers::pi;
  EXPECT_EQ(placed.section.shape, BeamSection::Shape::ellipse);
  EXPECT_NEAR(placed.section.area, pi / 4 * w * h, 1e-3 * placed.section.area);
  EXPECT_NEAR(placed.section.i11, pi / 64 * w * h * h * h, 2e-3 * placed.section.i11);
  EXPECT_NEAR(placed.section.i22, pi / 64 * w * w * w * h, 2e-3 * placed.section.i22);
  EXPECT_NEAR(std::abs(placed.n1.y()), 1, 1e-9);
  const double torsion = pi / 16 * std::pow(w * h, 3) / (w * w + h * h);
  EXPECT_NEAR(torsion_constant(body, 0.4, 1), torsion, 0.005 * torsion);
}

TEST(Beams, AlikeYarnsShareSectionsAndTouchingOnesAreListed) {
  const std::vector<yarn::Body> bodies = {straight_tube(1, 1, 6, 24, Vec3::Zero(), "a"),
                                          straight_tube(1, 1, 6, 24, Vec3(0, 0, 1.05), "b"),
                                          straight_tube(1, 1, 6, 24, Vec3(0, 0, 4), "c")};
  Diagnostics diagnostics;
  const Result<BeamModel> beams = make_beams({}, bodies, Unit::mm, {}, diagnostics);
  ASSERT_TRUE(beams.ok());
  EXPECT_EQ(beams->sections.size(), 1U);
  ASSERT_EQ(beams->contacts.size(), 1U);
  EXPECT_EQ(beams->contacts[0].a, 0U);
  EXPECT_EQ(beams->contacts[0].b, 1U);
  EXPECT_NEAR(beams->contacts[0].gap, 1.05 - 2 * beams->radii[0], 0.01);
  EXPECT_EQ(beams->mesh.regions[2].end_nodes.size(), 1U);
}

}  // namespace
}  // namespace selvage::fem
