#include "tetrahedra/mesher.h"

#include <algorithm>
#include <limits>
#include <map>
#include <string>

#include "core/sanitized.h"
#include "unit/fem/bodies.h"

namespace selvage::fem {
namespace {

using test::grid_body;
using test::straight_tube;

Mesh mesh_of(const std::vector<yarn::Body>& bodies, const MeshOptions& options, Unit units = Unit::mm) {
  Diagnostics diagnostics;
  Result<Mesh> mesh = mesh_yarns({}, bodies, units, options, diagnostics);
  if (!mesh) {
    ADD_FAILURE() << to_string(mesh.error());
    return {};
  }
  return std::move(*mesh);
}

yarn::Body ring() {
  return grid_body(
      "ring", 16, 16,
      [](double a, double s) {
        const double r = 3 + 0.5 * std::cos(a), turn = 2 * std::numbers::pi * s;
        return Vec3(r * std::cos(turn), r * std::sin(turn), -0.5 * std::sin(a));
      },
      true);
}

double area(const Mesh& mesh, const std::vector<ElementSide>& faces) {
  double sum = 0;
  for (const auto& f : faces)
    sum += (mesh.nodes[f[1]] - mesh.nodes[f[0]]).cross(mesh.nodes[f[2]] - mesh.nodes[f[0]]).norm() / 2;
  return sum;
}

TEST(Mesher, StraightTubeIsAreaTimesLength) {
  const Mesh mesh = mesh_of({straight_tube(1, 1, 5)}, {.size = 0.2});
  const Region& region = mesh.regions.front();
  EXPECT_NEAR(region.volume, 5 * area(mesh, region.start_faces), 0.02 * region.volume);
  EXPECT_NEAR(region.volume, region.exact_volume, 1e-9 * region.exact_volume);
  EXPECT_GE(mesh.quality.min_dihedral, 10);
  EXPECT_GT(mesh.quality.min_scaled_jacobian, 0);
  EXPECT_EQ(mesh.worst.size(), 10U);
  EXPECT_EQ(mesh.worst.front().min_dihedral, mesh.quality.min_dihedral);
  for (const std::size_t node : region.start_nodes) EXPECT_NEAR(mesh.nodes[node].x(), 0, 1e-12);
  for (const std::size_t node : region.end_nodes) EXPECT_NEAR(mesh.nodes[node].x(), 5, 1e-12);
}

// Its surface was cut open: nowhere does an edge go from one side of the cut to the other.
TEST(Mesher, AVeryLongTubeIsDividedAllAlong) {
  const Mesh mesh = mesh_of({straight_tube(1, 1, 150)}, {.size = 0.5});
  const Region& region = mesh.regions.front();
  EXPECT_NEAR(region.volume, region.exact_volume, 1e-9 * region.exact_volume);
  EXPECT_GE(mesh.quality.min_dihedral, 10);
  for (const auto& face : region.side_faces)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_LT((mesh.nodes[face[k]] - mesh.nodes[face[(k + 1) % 3]]).norm(), 2 * 0.5);
}

// Elements have the volume at any size, straight and curved ones: their nodes stand so.
TEST(Mesher, Volume) {
  for (const yarn::Body& body : {straight_tube(1, 1, 3), ring()})
    for (const double size : {0.24, 0.12})
      for (const int order : {1, 2}) {
        const Mesh mesh = mesh_of({body}, {.size = size, .order = order});
        EXPECT_NEAR(mesh.regions[0].volume / mesh.regions[0].exact_volume, 1, 1e-9)
            << body.name << ' ' << size << ' ' << order;
      }
}

TEST(Mesher, MidsideNodesAreOnTheSurfaceAndBetweenTheirCorners) {
  const yarn::Body body = straight_tube(1, 1, 3, 64);  // all but a circle, radius r
  const Mesh mesh = mesh_of({body}, {.size = 0.25, .order = 2});
  constexpr std::array<std::array<std::size_t, 2>, 6> ends = {
      {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
  double highest = 0;
  for (const Vec3& node : mesh.nodes) highest = std::max(highest, std::hypot(node.y(), node.z()));
  std::size_t curved = 0, held = 0;
  for (const auto& element : mesh.elements)
    for (std::size_t k = 0; k < 6; ++k) {
      const Vec3 chord = (mesh.nodes[element[ends[k][0]]] + mesh.nodes[element[ends[k][1]]]) / 2;
      const Vec3& middle = mesh.nodes[element[4 + k]];
      if ((middle - chord).norm() < 1e-12) continue;
      ++curved;
      const double low = highest - std::hypot(middle.y(), middle.z());
      EXPECT_LT(low, 0.02 * highest);    // of the chord: 0.06
      if (low > 1e-3 * highest) ++held;  // so that no element folds
      EXPECT_LT((middle - chord).norm(), 0.1 * (mesh.nodes[element[ends[k][0]]] - chord).norm() + 0.05);
    }
  EXPECT_GT(curved, 1000U);
  EXPECT_LT(held, curved / 50);
}

// Fibres of a twisted yarn lie on helices: at a radius r the unit vector to (1, w r) along and round it,
// where they turn by w a length.
TEST(Mesher, FibresFollowTheTwist) {
  const double turns = 0.15;  // a mm
  for (const double sign : {1.0, -1.0})
    for (const Unit unit : {Unit::mm, Unit::cm}) {
      yarn::Body body = straight_tube(1, 1, 3);
      body.twist = sign * turns;
      Diagnostics diagnostics;
      const Result<Mesh> mesh = mesh_yarns({}, std::vector{body}, unit, {.size = 0.25}, diagnostics);
      ASSERT_TRUE(mesh.ok());
      const double scale = millimetres_per(unit);
      double steepest = 0;
      for (std::size_t e = 0; e < mesh->elements.size(); ++e) {
        Vec3 middle = Vec3::Zero();
        for (std::size_t k = 0; k < 4; ++k) middle += mesh->nodes[mesh->elements[e][k]] / (4 * scale);
        // Z is right-handed: seen along x, y turns towards z.
        const double w = sign * 2 * std::numbers::pi * turns;
        const Vec3 wanted = Vec3(1, -w * middle.z(), w * middle.y()).normalized();
        EXPECT_LT((mesh->along[e] - wanted).norm(), 1e-9);
        EXPECT_NEAR(mesh->across[e].dot(mesh->along[e]), 0, 1e-14);
        steepest = std::max(steepest, std::hypot(wanted.y(), wanted.z()) / wanted.x());
      }
      EXPECT_GT(steepest, 0.3);
    }
}

// Edges get no longer than the yarn is thin, whatever is asked for.
TEST(Mesher, ASizeAboveTheThicknessIsTheThickness) {
  const Mesh mesh = mesh_of({straight_tube(1, 0.5, 5)}, {.size = 100});
  EXPECT_NEAR(mesh.regions[0].volume, mesh.regions[0].exact_volume, 2e-3 * mesh.regions[0].exact_volume);
  EXPECT_EQ(mesh.nodes, mesh_of({straight_tube(1, 0.5, 5)}, {.size = 0.5}).nodes);
}

TEST(Mesher, OrientationFollowsTheYarn) {
  const Mesh mesh = mesh_of({ring()}, {.size = 0.25});
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    Vec3 middle = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k) middle += mesh.nodes[mesh.elements[e][k]] / 4;
    const Vec3 round = Vec3(-middle.y(), middle.x(), 0).normalized();
    EXPECT_GT(mesh.along[e].dot(round), 0.9999);
    EXPECT_NEAR(mesh.along[e].norm(), 1, 1e-14);
    EXPECT_NEAR(mesh.across[e].norm(), 1, 1e-14);
    EXPECT_NEAR(mesh.across[e].dot(mesh.along[e]), 0, 1e-14);
  }
}

TEST(Mesher, UnitsBecomeMillimetres) {
  const Mesh mm = mesh_of({straight_tube(1, 1, 5)}, {.size = 0.3});
  const Mesh inch = mesh_of({straight_tube(1, 1, 5)}, {.size = 0.3}, Unit::inch);
  ASSERT_EQ(mm.nodes.size(), inch.nodes.size());
  EXPECT_NEAR(inch.regions[0].volume, mm.regions[0].volume * 25.4 * 25.4 * 25.4, 1e-6);
  EXPECT_NEAR(inch.regions[0].exact_volume, mm.regions[0].exact_volume * 25.4 * 25.4 * 25.4, 1e-6);
}

TEST(Mesher, SeveralYarnsAtOnceGiveTheSameMesh) {
  std::vector<yarn::Body> bodies;
  for (int i = 0; i < 5; ++i)
    bodies.push_back(straight_tube(1, 0.5 + 0.1 * i, 2, 16, Vec3(0, 2 * i, 0), "yarn" + std::to_string(i)));
  std::map<std::string, std::size_t> calls;
  MeshOptions options{.size = 0.2, .order = 2};
  const Mesh one = mesh_of(bodies, options);
  options.threads = 4;
  options.progress = [&](const char* step, std::size_t, std::size_t total) {
    calls[step] += total == 5 ? 1 : 100;
  };
  const Mesh four = mesh_of(bodies, options);
  EXPECT_EQ(calls,
            (std::map<std::string, std::size_t>{{"meshing the surface of yarn", 5}, {"filling yarn", 5}}));
  EXPECT_EQ(one.nodes, four.nodes);
  EXPECT_EQ(one.elements, four.elements);
  EXPECT_EQ(one.along, four.along);
  for (std::size_t i = 0; i < 5; ++i) {
    const Region& region = four.regions[i];
    EXPECT_EQ(region.name, "yarn" + std::to_string(i));
    for (std::size_t e = region.first_element; e < region.last_element; ++e)
      for (const std::size_t node : four.elements[e]) {
        EXPECT_GE(node, region.first_node);
        EXPECT_LT(node, region.last_node);
      }
  }
}

TEST(Mesher, SelfIntersectionNamesYarnPlaceAndRemedy) {
  const yarn::Body good = straight_tube(1, 1, 3, 16, Vec3(0, 9, 0), "good");
  const yarn::Body bad = grid_body("tight", 16, 24, [](double a, double s) {
    const double turn = 6 * s, r = 0.3 + 0.5 * std::cos(a);  // a bend of 0.3 with a half section of 0.5
    return Vec3(r * std::cos(turn), r * std::sin(turn), -0.5 * std::sin(a));
  });
  Diagnostics diagnostics;
  for (const int threads : {1, 3}) {
    const std::vector<yarn::Body> bodies = {good, bad, good};
    const Result<Mesh> mesh =
        mesh_yarns({}, bodies, Unit::mm, {.size = 0.2, .threads = threads}, diagnostics);
    ASSERT_FALSE(mesh.ok());
    EXPECT_EQ(mesh.error().kind, Kind::geometry);
    EXPECT_EQ(mesh.error().yarn, "tight");
    ASSERT_TRUE(mesh.error().at);
    EXPECT_LT(mesh.error().at->norm(), 1);
  }
}

TEST(Mesher, LimitsAndWrongOptions) {
  Diagnostics diagnostics;
  const std::vector<yarn::Body> bodies = {straight_tube(1, 1, 5)};
  auto kind = [&](const MeshOptions& options) {
    const Result<Mesh> mesh = mesh_yarns({}, bodies, Unit::mm, options, diagnostics);
    return mesh ? Kind::malformed : mesh.error().kind;
  };
  EXPECT_EQ(kind({.size = 0.001}), Kind::limit);  // 5e10 tetrahedra
  EXPECT_EQ(kind({.order = 3}), Kind::usage);
  EXPECT_EQ(kind({.size = -1}), Kind::usage);
  EXPECT_EQ(kind({.min_dihedral = 75}), Kind::usage);
  EXPECT_EQ(kind({.size = 0.04, .timeout = 0.01}), Kind::limit);
  if (!sanitized) {
    EXPECT_EQ(kind({.size = 0.03, .memory = 64}), Kind::limit);
  }
  EXPECT_EQ(mesh_yarns({}, {}, Unit::mm, {}, diagnostics).error().kind, Kind::geometry);
}

TEST(Mesher, DihedralTargetThatIsMissedIsAWarning) {
  Diagnostics diagnostics;
  const std::vector<yarn::Body> bodies = {straight_tube(0.8, 0.2, 2)};
  ASSERT_TRUE(mesh_yarns({}, bodies, Unit::mm, {.min_dihedral = 30}, diagnostics).ok());
  EXPECT_TRUE(
      std::any_of(diagnostics.messages().begin(), diagnostics.messages().end(), [](const Message& message) {
        return message.severity == Severity::warning && message.text.find("dihedral") != std::string::npos;
      }));
}

}  // namespace
}  // namespace selvage::fem
