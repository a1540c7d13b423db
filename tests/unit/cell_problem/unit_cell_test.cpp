#include "cell_problem/complete_cell.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <set>

#include "cell_problem/supports.h"
#include "fem/fibre.h"
#include "structured/voxel.h"
#include "unit/fem/bodies.h"

namespace selvage::fem {
namespace {

fabric::Material material(const std::string& name, const decltype(fabric::Material::elastic)& elastic) {
  fabric::Material result;
  result.name = name;
  result.elastic = elastic;
  return result;
}

fabric::Fabric fabric_of(const Vec3& low, const Vec3& high) {
  fabric::Fabric fabric;
  fabric.materials = {material("glass", fabric::TransverseElastic{57500, 18800, 0.25, 7440, 0.29}),
                      material("resin", fabric::IsotropicElastic{3400, 0.35})};
  fabric::Cell cell;
  cell.low = low;
  cell.high = high;
  cell.matrix = "resin";
  fabric.cell = cell;
  return fabric;
}

// A straight yarn along x through the middle of a cell 2 x 1.5 x 1, in voxels.
Mesh straight_cell(std::array<bool, 3> periodic, int count = 12, bool matrix = true,
                   Physics physics = Physics::elastic) {
  std::vector<yarn::Body> bodies = {test::straight_tube(0.8, 0.5, 4, 24, Vec3(-1, 0.75, 0.5))};
  bodies[0].material = "glass";
  bodies[0].fibre_area = 0.2;
  Diagnostics diagnostics;
  fabric::Fabric fabric = fabric_of(Vec3(0, 0, 0), Vec3(2, 1.5, 1));
  for (fabric::Material& material : fabric.materials) material.conductivity = fabric::Transport{1, 1};
  Result<Mesh> mesh =
      mesh_voxels(fabric, bodies,
                  {.count = count, .periodic = periodic, .matrix = matrix, .physics = physics}, diagnostics);
  EXPECT_TRUE(mesh.ok()) << mesh.error().text;
  // 12 voxels fill another share than the yarn, which is said.
  for (const Message& message : diagnostics.messages())
    EXPECT_NE(message.text.find("which are too coarse"), std::string::npos) << message.text;
  return mesh.ok() ? *mesh : Mesh{};
}

// What is left of each equation, at most, when the nodes are displaced by `field` and the drivers by
// `values`.
double largest_rest(const Mesh& mesh, const std::vector<double>& values,
                    const std::function<Vec3(const Vec3&)>& field) {
  double largest = 0;
  for (const Equation& equation : mesh.equations) {
    double sum = 0;
    for (const Term& term : equation)
      sum += term.factor * (term.node < mesh.nodes.size() ? field(mesh.nodes[term.node])[term.direction]
                                                          : values[term.node - mesh.nodes.size()]);
    largest = std::max(largest, std::abs(sum));
  }
  return largest;
}

// No displacement is eliminated twice, and none that is eliminated is used by another equation.
void expect_clean(const Mesh& mesh) {
  std::set<std::pair<std::size_t, int>> eliminated;
  for (const Equation& equation : mesh.equations) {
    EXPECT_TRUE(eliminated.emplace(equation[0].node, equation[0].direction).second);
    EXPECT_LT(equation[0].node, mesh.nodes.size());
  }
  for (const Equation& equation : mesh.equations)
    for (std::size_t i = 1; i < equation.size(); ++i)
      EXPECT_FALSE(eliminated.contains({equation[i].node, equation[i].direction}));
}

TEST(UnitCell, BlockCarriesEveryStrain) {
  const Mesh mesh = straight_cell({true, true, true});
  ASSERT_EQ(mesh.drivers.size(), 6U);
  ASSERT_EQ(mesh.load_cases.size(), 7U);
  expect_clean(mesh);
  const std::vector<double> values = {0.3, -0.2, 0.7, 0.11, -0.13, 0.17};  // xx yy zz xy xz yz
  Eigen::Matrix3d strain;
  strain << 0.3, 0.055, -0.065, 0.055, -0.2, 0.085, -0.065, 0.085, 0.7;
  const Vec3 repeats(0.4, 0.2, 0.1);
  // An affine field plus one that repeats (with the cell's sides 2, 1.5, 1).
  EXPECT_LT(largest_rest(mesh, values,
                         [&](const Vec3& p) {
                           return Vec3(strain * p + repeats * std::sin(std::numbers::pi * p.x()) *
                                                        std::cos(4 * std::numbers::pi / 3 * p.y()) *
                                                        std::cos(2 * std::numbers::pi * p.z()));
                         }),
            1e-14);
  // Every node of the low faces' own is free, every other one of the faces is not: 3 equations a node.
  const std::size_t nx = 12, ny = 9, nz = 6;
  EXPECT_EQ(mesh.equations.size(), 3 * ((nx + 1) * (ny + 1) * (nz + 1) - nx * ny * nz));
  ASSERT_EQ(supports(mesh).size(), 1U);
  EXPECT_EQ(supports(mesh)[0].node, mesh.cell->corners[0]);
  EXPECT_FALSE(supports(mesh)[0].direction);
}

TEST(UnitCell, PlateCarriesStrainsAndCurvatures) {
  const Mesh mesh = straight_cell({true, true, false});
  ASSERT_EQ(mesh.drivers.size(), 6U);
  EXPECT_EQ(mesh.drivers[2].name, "ConstraintsDriver3");
  EXPECT_EQ(mesh.drivers[3].name, "CurvatureDriver0");
  expect_clean(mesh);
  const std::vector<double> values = {0.3, -0.2, 0.11, 0.4, -0.6, 0.9};
  EXPECT_LT(largest_rest(mesh, values,
                         [&](const Vec3& at) {
                           const Vec3 p = at - Vec3(1, 0.75, 0.5);
                           const double xx = 0.3 + 0.4 * p.z(), yy = -0.2 - 0.6 * p.z(),
                                        half_xy = (0.11 + 0.9 * p.z()) / 2;
                           return Vec3(
                               xx * p.x() + half_xy * p.y() + std::sin(std::numbers::pi * at.x()) * at.z(),
                               half_xy * p.x() + yy * p.y(),
                               -(0.4 * p.x() * p.x() - 0.6 * p.y() * p.y() + 0.9 * p.x() * p.y()) / 2);
                         }),
            1e-14);
}

// Along each axis: stretch, twist, both bendings and what repeats meet all conditions; nothing but the
// conditions and the supports is left to move as a whole.
TEST(UnitCell, BeamCarriesStretchTwistAndBending) {
  const Vec3 sides(2, 1.5, 1), middle(1, 0.75, 0.5);
  for (int a = 0; a < 3; ++a) {
    std::array<bool, 3> periodic{};
    periodic[static_cast<std::size_t>(a)] = true;
    const Mesh mesh = straight_cell(periodic);
    ASSERT_EQ(mesh.drivers.size(), 4U);
    ASSERT_EQ(mesh.load_cases.size(), 5U);
    EXPECT_EQ(mesh.drivers[3].name, "BeamDriver3");
    expect_clean(mesh);
    const int b = a == 0 ? 1 : 0, c = a == 2 ? 1 : 2;  // in order
    EXPECT_EQ(mesh.load_cases[2].name, std::string("bending ") + "xyz"[a] + "xyz"[b]);
    const auto field = [&](const Vec3& at, double repeats) {
      const Vec3 p = at - middle;
      const double x = p[a], wave = repeats * std::sin(2 * std::numbers::pi * x / sides[a]);
      Vec3 u = wave * Vec3(1, 2, 3) + 0.9 * x * Vec3::Unit(a).cross(p);
      u[a] += x * (0.3 + 0.4 * p[b] - 0.6 * p[c]);
      u[b] -= 0.4 * x * x / 2;
      u[c] += 0.6 * x * x / 2;
      return u;
    };
    EXPECT_LT(largest_rest(mesh, {0.3, 0.9, 0.4, -0.6}, [&](const Vec3& at) { return field(at, 0.7); }),
              1e-14);
    // A cross section that turns about another axis is bent; about its own it is held by the second support.
    const Vec3 turn = Vec3::Unit(b);
    EXPECT_GT(largest_rest(mesh, {0, 0, 0, 0}, [&](const Vec3& at) { return Vec3(turn.cross(at)); }), 0.1);
    const auto twist = [&](const Vec3& at) { return Vec3(Vec3::Unit(a).cross(at)); };
    EXPECT_LT(largest_rest(mesh, {0, 0, 0, 0}, twist), 1e-14);
    const std::vector<NodeSupport> held = supports(mesh);
    ASSERT_EQ(held.size(), 2U);
    ASSERT_TRUE(held[1].direction);
    EXPECT_GT(
        std::abs((twist(mesh.nodes[held[1].node]) - twist(mesh.nodes[held[0].node]))[*held[1].direction]),
        0.5);
  }
}

TEST(UnitCell, ABeamOfYarnsAloneHoldsEach) {
  const Mesh mesh = straight_cell({true, false, false}, 12, false);
  EXPECT_EQ(mesh.load_cases.size(), 5U);
  EXPECT_EQ(supports(mesh).size(), 2U);
  std::set<std::size_t> dependent;
  for (const Equation& equation : mesh.equations) dependent.insert(equation.front().node);
  for (const NodeSupport& support : supports(mesh)) EXPECT_FALSE(dependent.contains(support.node));
}

TEST(UnitCell, WithoutPeriodsTheWholeFaceFollowsTheStrain) {
  const Mesh mesh = straight_cell({false, false, false});
  expect_clean(mesh);
  EXPECT_LT(largest_rest(mesh, {1, 2, 3, 0, 0, 0.5},
                         [](const Vec3& at) {
                           const Vec3 p = at - Vec3(1, 0.75, 0.5);
                           return Vec3(p.x(), 2 * p.y() + 0.25 * p.z(), 3 * p.z() + 0.25 * p.y());
                         }),
            1e-14);
  EXPECT_TRUE(supports(mesh).empty());
}

// The potential is an affine field plus one that repeats; of a plate it has no gradient across.
TEST(UnitCell, ConductingCellsCarryEveryGradient) {
  for (const auto& [periodic, axes] :
       {std::pair{std::array{true, true, true}, 3U}, std::pair{std::array{true, true, false}, 2U},
        std::pair{std::array{false, false, false}, 3U}}) {
    const Mesh mesh = straight_cell(periodic, 12, true, Physics::conduction);
    ASSERT_EQ(mesh.drivers.size(), axes);
    ASSERT_EQ(mesh.load_cases.size(), axes);
    EXPECT_EQ(mesh.drivers[1].name, "GradientDriver1");
    EXPECT_EQ(mesh.load_cases[1].name, "gradient y");
    expect_clean(mesh);
    const std::vector<double> gradient = {0.3, -0.2, axes == 3 ? 0.7 : 0.0};
    const double repeats = periodic[0] ? 0.4 : 0;
    EXPECT_LT(largest_rest(mesh, gradient,
                           [&](const Vec3& at) {
                             const Vec3 p = at - Vec3(1, 0.75, 0.5);
                             return Vec3(0.3 * p.x() - 0.2 * p.y() + gradient[2] * p.z() +
                                             repeats * std::sin(std::numbers::pi * at.x()) *
                                                 std::cos(4 * std::numbers::pi / 3 * at.y()) *
                                                 std::cos(2 * std::numbers::pi * at.z()),
                                         0, 0);
                           }),
              1e-14);
    for (const Equation& equation : mesh.equations)
      for (const Term& term : equation) EXPECT_EQ(term.direction, 0);
  }
}

TEST(UnitCell, SetsAreWholeAndOpposite) {
  const Mesh mesh = straight_cell({true, true, true});
  const UnitCell& cell = *mesh.cell;
  EXPECT_EQ(cell.face_nodes[0].size(), 8U * 5U);
  EXPECT_EQ(cell.edge_nodes[0].size(), 11U);
  EXPECT_EQ(cell.edge_nodes[5].size(), 8U);
  for (std::size_t corner = 0; corner < 8; ++corner)
    EXPECT_EQ(mesh.nodes[cell.corners[corner]],
              Vec3((corner & 1) != 0 ? 2 : 0, (corner & 2) != 0 ? 1.5 : 0, (corner & 4) != 0 ? 1 : 0));
  // Edge 4 a + k: along y (a = 1), high in z (the axis after y), low in x.
  for (const std::size_t node : cell.edge_nodes[5]) {
    EXPECT_EQ(mesh.nodes[node].z(), 1);
    EXPECT_EQ(mesh.nodes[node].x(), 0);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto &high = cell.face_nodes[2 * axis], &low = cell.face_nodes[2 * axis + 1];
    ASSERT_EQ(high.size(), low.size());
    for (std::size_t k = 0; k < high.size(); ++k) {
      const Vec3 way = mesh.nodes[high[k]] - mesh.nodes[low[k]];
      EXPECT_EQ(way, Vec3((cell.high - cell.low)[static_cast<Eigen::Index>(axis)] *
                          Vec3::Unit(static_cast<Eigen::Index>(axis))));
    }
  }
  for (std::size_t face = 0; face < 6; ++face) {
    // The sides tile the face, and look outward.
    const auto axis = static_cast<Eigen::Index>(face / 2);
    double area = 0;
    for (const auto& side : cell.face_sides[face])
      area +=
          (mesh.nodes[side[2]] - mesh.nodes[side[0]]).cross(mesh.nodes[side[3]] - mesh.nodes[side[1]])[axis] /
          2;
    EXPECT_NEAR(area, (face % 2 == 0 ? 1 : -1) * 3.0 / (cell.high - cell.low)[axis], 1e-12);
  }
  for (std::size_t k = 0; k < cell.face_sides[0].size(); ++k) {
    Vec3 way = Vec3::Zero();
    for (std::size_t i = 0; i < 4; ++i)
      way += (mesh.nodes[cell.face_sides[0][k][i]] - mesh.nodes[cell.face_sides[1][k][i]]) / 4;
    EXPECT_LT((way - Vec3(2, 0, 0)).norm(), 1e-12);
  }
}

TEST(UnitCell, FacesThatDoNotMatchAreAnError) {
  Mesh mesh = straight_cell({true, true, true});
  const std::size_t node = mesh.cell->face_nodes[0][7];
  mesh.nodes[node].y() += 1e-9;
  const Status done = complete_cell(mesh, Box3(Vec3(0, 0, 0), Vec3(2, 1.5, 1)), {true, true, true});
  ASSERT_FALSE(done.ok());
  EXPECT_EQ(done.error().kind, Kind::geometry);
  mesh.nodes[node].y() -= 1e-9;
  mesh.nodes[node].x() += 1e-11;
  EXPECT_EQ(complete_cell(mesh, Box3(Vec3(0, 0, 0), Vec3(2, 1.5, 1)), {true, true, true}).error().kind,
            Kind::internal);
}

TEST(UnitCell, YarnsThatFlyApartHaveNoLoadCases) {
  std::vector<yarn::Body> bodies = {test::straight_tube(0.5, 0.4, 4, 24, Vec3(-1, 0.4, 0.5), "a"),
                                    test::straight_tube(0.5, 0.4, 4, 24, Vec3(-1, 1.1, 0.5), "b")};
  Diagnostics diagnostics;
  fabric::Fabric fabric = fabric_of(Vec3(0, 0, 0), Vec3(2, 1.5, 1));
  const Result<Mesh> mesh = mesh_voxels(
      fabric, bodies, {.count = 20, .periodic = {true, true, false}, .matrix = false}, diagnostics);
  ASSERT_TRUE(mesh.ok());
  EXPECT_EQ(mesh->regions.size(), 2U);
  EXPECT_TRUE(mesh->load_cases.empty());
  EXPECT_FALSE(mesh->equations.empty());
}

TEST(Voxels, FillTheCellAndConvergeToTheYarnsVolume) {
  const double exact = [] {
    const yarn::Body body = test::straight_tube(0.8, 0.5, 4);
    return body.volume / 2;  // half of its length is inside
  }();
  double before = 1;
  for (const int count : {20, 80}) {
    const Mesh mesh = straight_cell({true, true, true}, count);
    ASSERT_EQ(mesh.regions.size(), 2U);
    EXPECT_EQ(mesh.regions[1].kind, Region::Kind::matrix);
    EXPECT_NEAR(mesh.regions[0].volume + mesh.regions[1].volume, 3, 1e-12);
    const double error = std::abs(mesh.regions[0].volume - exact) / exact;
    EXPECT_LT(error, before / 2);
    before = error;
  }
  EXPECT_LT(before, 0.01);
}

TEST(Voxels, CarryTheFibresOfTheirYarn) {
  const Mesh mesh = straight_cell({true, true, true});
  const yarn::Body body = test::straight_tube(0.8, 0.5, 4);
  const double area = body.volume / body.length;
  for (std::size_t e = 0; e < mesh.regions[0].last_element; ++e) {
    EXPECT_LT((mesh.along[e] - Vec3::UnitX()).norm(), 1e-12);
    // Towards the seam, which on this grid stands half a step of its 24 from the section's width.
    EXPECT_LT((mesh.across[e] - Vec3::UnitY()).norm(), std::numbers::pi / 24);
    EXPECT_LT(std::abs(mesh.across[e].dot(mesh.along[e])), 1e-12);
    EXPECT_NEAR(mesh.fibre_fraction[e], 0.2 / area, 1e-9);
  }
  EXPECT_EQ(mesh.fibre_fraction[mesh.regions[1].first_element], 0);
}

TEST(Fibres, ChamisAtItsLimitsAndOnAPublishedCase) {
  const fabric::Material fibre = material("f", fabric::TransverseElastic{230000, 15000, 0.2, 24000, 0.25});
  const fabric::Material matrix = material("m", fabric::IsotropicElastic{3400, 0.35});
  // Hardly any fibres: the matrix.
  const auto thin = std::get<fabric::TransverseElastic>(chamis(fibre, matrix, 1e-12).elastic);
  EXPECT_NEAR(thin.e1, 3400, 1e-3);
  EXPECT_NEAR(thin.e2, 3400, 0.1);
  EXPECT_NEAR(thin.g12, 3400 / 2.7, 0.1);
  EXPECT_NEAR(thin.nu23, 0.35, 1e-4);
  // Fibres only: the fibre.
  const auto full = std::get<fabric::TransverseElastic>(chamis(fibre, matrix, 1 - 1e-12).elastic);
  EXPECT_NEAR(full.e2, 15000, 1e-3);
  EXPECT_NEAR(full.g12, 24000, 1e-3);
  EXPECT_NEAR(full.nu23, 0.25, 1e-6);
  // By hand at 0.64, whose root is 0.8: E2 = 3400 / (1 - 0.8 (1 - 3400 / 15000)).
  const auto yarn = std::get<fabric::TransverseElastic>(chamis(fibre, matrix, 0.64).elastic);
  EXPECT_NEAR(yarn.e1, 0.64 * 230000 + 0.36 * 3400, 1e-9);
  EXPECT_NEAR(yarn.e2, 3400 / (0.2 + 0.8 * 3400 / 15000), 1e-9);
  EXPECT_NEAR(yarn.nu12, 0.64 * 0.2 + 0.36 * 0.35, 1e-12);
}

// By hand at 0.64, where the root less the fraction is 0.16.
TEST(Fibres, StrengthsOfYarnsByChamis) {
  fabric::Material fibre = material("f", fabric::TransverseElastic{230000, 15000, 0.2, 24000, 0.25});
  fabric::Material matrix = material("m", fabric::IsotropicElastic{3400, 0.35});
  fibre.strength = fabric::TransverseStrength{2500, 2000, {}};
  matrix.strength = fabric::IsotropicStrength{80, 120, {}};
  EXPECT_TRUE(std::holds_alternative<std::monostate>(chamis(fibre, matrix, 0.64).strength));
  matrix.strength = fabric::IsotropicStrength{80, 120, 70};
  auto yarn = std::get<fabric::TransverseStrength>(chamis(fibre, matrix, 0.64).strength);
  const double across = 1 - 0.16 * (1 - 3400.0 / 15000), along = 1 - 0.16 * (1 - 3400 / 2.7 / 24000);
  EXPECT_NEAR(yarn.tension, 1600, 1e-9);
  EXPECT_NEAR(yarn.across->tension, across * 80, 1e-9);
  EXPECT_NEAR(yarn.across->compression, across * 120, 1e-9);
  EXPECT_NEAR(yarn.across->s12, along * 70, 1e-9);
  EXPECT_NEAR(yarn.across->s23, across * 60, 1e-9);
  EXPECT_NEAR(yarn.compression, 10 * along * 70 + 200, 1e-9);  // 800.9: shear, before crushing (1280)
  fibre.strength = fabric::IsotropicStrength{2500, 500, {}};
  yarn = std::get<fabric::TransverseStrength>(chamis(fibre, matrix, 0.64).strength);
  EXPECT_NEAR(yarn.compression, 320, 1e-9);  // crushing
  matrix.strength = fabric::IsotropicStrength{800, 1200, 700};
  fibre.strength = fabric::IsotropicStrength{2500, 9000, {}};
  yarn = std::get<fabric::TransverseStrength>(chamis(fibre, matrix, 0.64).strength);
  const double g = 3400 / 2.7;
  EXPECT_NEAR(yarn.compression, g / (1 - 0.64 * (1 - g / 24000)), 1e-9);  // 3211: microbuckling
}

}  // namespace
}  // namespace selvage::fem
