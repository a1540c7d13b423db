// Cells of a few tetrahedra whose regions share no nodes: which nodes there are, and which move alike.
#include "cell_problem/interfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "cell_problem/complete_cell.h"
#include "fem/cohesive_law.h"
#include "fem/sides.h"

namespace selvage::fem {
namespace {

constexpr int cubes_each_way = 4;  // cubes along each side

// A cube of 4 x 4 x 4 cubes, each of six tetrahedra (H. W. Kuhn's, along the ways from its low to its high
// corner, so that opposite sides have the same triangles); the region by the middle of a tetrahedron.
Mesh cube(std::size_t regions, const std::function<std::size_t(const Vec3&)>& region_of,
          bool is_periodic_in_z = true) {
  Mesh mesh;
  std::vector<std::vector<std::array<std::size_t, 10>>> elements(regions);
  const auto node = [](const std::array<int, 3>& p) {
    return static_cast<std::size_t>((p[2] * (cubes_each_way + 1) + p[1]) * (cubes_each_way + 1) + p[0]);
  };
  for (int z = 0; z <= cubes_each_way; ++z)
    for (int y = 0; y <= cubes_each_way; ++y)
      for (int x = 0; x <= cubes_each_way; ++x) mesh.nodes.emplace_back(x, y, z);
  for (int at = 0; at < cubes_each_way * cubes_each_way * cubes_each_way; ++at) {
    std::array<int, 3> ways = {0, 1, 2};
    do {
      std::array<int, 3> p = {at % cubes_each_way, at / cubes_each_way % cubes_each_way,
                              at / cubes_each_way / cubes_each_way};
      std::array<std::size_t, 10> element{};
      element[0] = node(p);
      for (std::size_t k = 0; k < 3; ++k) {
        ++p[static_cast<std::size_t>(ways[k])];
        element[k + 1] = node(p);
      }
      const auto edge = [&](std::size_t k) { return Vec3(mesh.nodes[element[k]] - mesh.nodes[element[0]]); };
      if (edge(1).cross(edge(2)).dot(edge(3)) < 0) std::swap(element[2], element[3]);
      Vec3 middle = Vec3::Zero();
      for (std::size_t k = 0; k < 4; ++k) middle += mesh.nodes[element[k]] / 4;
      elements[region_of(middle)].push_back(element);
    } while (std::next_permutation(ways.begin(), ways.end()));
  }
  for (std::size_t r = 0; r < regions; ++r) {
    Region region;
    region.kind = r + 1 == regions ? Region::Kind::matrix : Region::Kind::yarn;
    region.name = std::string(1, static_cast<char>('a' + r));
    region.material = region.name;
    region.first_element = mesh.elements.size();
    mesh.elements.insert(mesh.elements.end(), elements[r].begin(), elements[r].end());
    region.last_element = mesh.elements.size();
    mesh.regions.push_back(region);
  }
  mesh.joining = Joining::cohesive;
  const Status done =
      complete_cell(mesh, Box3(Vec3::Zero(), Vec3::Constant(cubes_each_way)), {true, true, is_periodic_in_z});
  EXPECT_TRUE(done.ok()) << (done.ok() ? "" : done.error().text);
  return mesh;
}

// Of each node its only region.
std::vector<std::size_t> regions_of_nodes(const Mesh& mesh) {
  constexpr std::size_t none = 99;
  std::vector<std::size_t> regions(mesh.nodes.size(), none);
  for (std::size_t r = 0; r < mesh.regions.size(); ++r)
    for (std::size_t e = mesh.regions[r].first_element; e < mesh.regions[r].last_element; ++e)
      for (const std::size_t n : mesh.nodes_of(e)) {
        EXPECT_TRUE(regions[n] == none || regions[n] == r);
        regions[n] = r;
      }
  return regions;
}

// What each node that depends does depend on.
std::map<std::size_t, std::size_t> masters(const Mesh& mesh) {
  std::map<std::size_t, std::size_t> found;
  for (const Equation& equation : mesh.equations)
    if (equation.size() > 1 && equation[1].node < mesh.nodes.size())
      found[equation[0].node] = equation[1].node;
  for (const auto& [node, master] : found) EXPECT_FALSE(found.contains(master));
  return found;
}

bool is_within(double x, double low, double high) {
  return low < x && x < high;
}

TEST(Interfaces, WedgesLieBetweenTheRegionsAndLookOutOfTheFirst) {
  const Mesh mesh = cube(2, [](const Vec3& p) { return is_within(p.z(), 1, 3) ? 0U : 1U; });
  const std::vector<std::size_t> region = regions_of_nodes(mesh);
  ASSERT_EQ(mesh.interfaces.size(), 1U);
  EXPECT_EQ(mesh.interfaces[0].sides.size(), 2U * 2U * 16U);
  EXPECT_EQ(mesh.nodes.size(), 125U + 2U * 25U);
  for (const FacingSides& facing : mesh.interfaces[0].sides) {
    const auto& n = facing.first.nodes;
    const Vec3 normal = (mesh.nodes[n[1]] - mesh.nodes[n[0]]).cross(mesh.nodes[n[2]] - mesh.nodes[n[0]]);
    EXPECT_GT(normal.z() * (mesh.nodes[n[0]].z() - 2), 0);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(mesh.nodes[n[k]], mesh.nodes[facing.second.nodes[k]]);
      EXPECT_EQ(region[n[k]], 0U);
      EXPECT_EQ(region[facing.second.nodes[k]], 1U);
    }
    for (const auto* side : {&facing.first, &facing.second}) {
      std::set<std::size_t> corners;
      for (const std::size_t k : element_sides(mesh.shape)[side->side])
        corners.insert(mesh.elements[side->element][k]);
      EXPECT_EQ(corners, std::set<std::size_t>(side->nodes.begin(), side->nodes.begin() + 3));
    }
  }
}

TEST(Interfaces, BothSidesAreOppositeTheirLike) {
  const Mesh mesh = cube(2, [](const Vec3& p) { return is_within(p.z(), 1, 3) ? 0U : 1U; });
  const std::vector<std::size_t> region = regions_of_nodes(mesh);
  const UnitCell& cell = *mesh.cell;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto &high = cell.face_nodes[2 * axis], &low = cell.face_nodes[2 * axis + 1];
    ASSERT_EQ(low.size(), 9U + 2U * 3U);
    ASSERT_EQ(high.size(), low.size());
    for (std::size_t k = 0; k < low.size(); ++k) {
      EXPECT_EQ(region[high[k]], region[low[k]]);
      EXPECT_EQ(mesh.nodes[high[k]] - mesh.nodes[low[k]],
                cubes_each_way * Vec3::Unit(static_cast<int>(axis)));
    }
  }
  EXPECT_EQ(cell.edge_nodes[8].size(), 3U + 2U);  // along z
  for (std::size_t k = 0; k < cell.edge_nodes[8].size(); ++k)
    for (std::size_t edge = 9; edge < 12; ++edge)
      EXPECT_EQ(region[cell.edge_nodes[edge][k]], region[cell.edge_nodes[8][k]]);
  for (const auto& [node, master] : masters(mesh)) EXPECT_EQ(region[node], region[master]);
}

TEST(Interfaces, AYarnMayGoOnAsAnotherOne) {
  // Two yarns in one row: they meet in the middle, and over the faces across x.
  const Mesh mesh = cube(3, [](const Vec3& p) {
    if (!is_within(p.y(), 1, 3) || !is_within(p.z(), 1, 3)) return 2U;
    return p.x() < 2 ? 0U : 1U;
  });
  const std::vector<std::size_t> region = regions_of_nodes(mesh);
  ASSERT_EQ(mesh.interfaces.size(), 3U);
  EXPECT_EQ(mesh.interfaces[0].sides.size(), 2U * 4U);  // between the two
  std::size_t between = 0;
  for (const auto& [node, master] : masters(mesh)) {
    if (region[node] == 2) {
      EXPECT_EQ(region[master], 2U);
      continue;
    }
    EXPECT_EQ(region[node], 1U);
    EXPECT_EQ(region[master], 0U);
    ++between;
  }
  EXPECT_EQ(between, 9U);
  std::map<std::array<double, 3>, int> at;
  for (const Vec3& p : mesh.nodes) ++at[{p.x(), p.y(), p.z()}];
  EXPECT_EQ((at[{2, 1, 2}]), 3);  // all three regions meet
  EXPECT_EQ((at[{2, 2, 2}]), 2);
}

TEST(Interfaces, ASurfaceThroughAnEdgeIsTiedWhereTheRegionIs) {
  // Planes x - y = 0, -2, 2: through two edges along z, of which the others have one of the regions alone.
  const Mesh mesh = cube(2, [](const Vec3& p) {
    const double way = p.x() - p.y() + (p.x() < p.y() ? cubes_each_way : 0);
    return way < 2 ? 0U : 1U;
  });
  const std::vector<std::size_t> region = regions_of_nodes(mesh);
  const std::map<std::size_t, std::size_t> depends = masters(mesh);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const Vec3& p = mesh.nodes[n];
    const bool is_high = (p.array() == cubes_each_way).any();
    EXPECT_EQ(depends.contains(n), is_high);
    if (!is_high) continue;
    const std::size_t master = depends.at(n);
    EXPECT_EQ(region[master], region[n]);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(mesh.nodes[master][axis], p[axis] == cubes_each_way ? 0 : p[axis]);
  }
}

TEST(Interfaces, APlateHasBothSidesFreeAtTheTop) {
  const Mesh mesh = cube(
      2, [](const Vec3& p) { return is_within(p.x(), 1, 3) ? 0U : 1U; }, false);
  const std::vector<std::size_t> region = regions_of_nodes(mesh);
  EXPECT_EQ(mesh.cell->face_nodes[4].size(), 9U + 2U * 3U);
  EXPECT_EQ(mesh.cell->edge_nodes[0].size(), 3U + 2U);  // along x
  for (const auto& [node, master] : masters(mesh)) EXPECT_EQ(region[node], region[master]);
}

TEST(CohesiveLaw, DefaultsAndTheWeakerOne) {
  Mesh mesh = cube(2, [](const Vec3& p) { return is_within(p.z(), 1, 3) ? 0U : 1U; });
  mesh.regions[0].exact_volume = 32;
  mesh.materials.resize(2);
  mesh.materials[0].name = "a";
  mesh.materials[1].name = "b";
  mesh.materials[0].elastic = fabric::TransverseElastic{100, 20, 0.2, 5, 0.3};
  mesh.materials[1].elastic = fabric::IsotropicElastic{3, 0.3};
  ASSERT_TRUE(choose_cohesive_laws(mesh).ok());
  ASSERT_EQ(mesh.laws.size(), 1U);
  EXPECT_EQ(mesh.laws[0].name, "a_b");
  EXPECT_DOUBLE_EQ(mesh.laws[0].stiffness.normal, 1e4 * 20 / 4);  // four volumes over the area
  EXPECT_FALSE(mesh.laws[0].fracture);
  mesh.materials[0].interface = {.stiffness = {{50, 7}}, .strength = {{1, 2}}, .energy = {{1, 1}}};
  mesh.materials[1].interface = {.stiffness = {{40, 8}}, .strength = {}, .energy = {}};
  ASSERT_TRUE(choose_cohesive_laws(mesh).ok());
  EXPECT_EQ(mesh.laws[0].stiffness, (fabric::Interface::Pair{40, 7}));
  ASSERT_TRUE(mesh.laws[0].fracture);
  EXPECT_EQ(mesh.laws[0].fracture->strength, (fabric::Interface::Pair{1, 2}));
  mesh.materials[0].interface->energy = {{1, 0.1}};
  const Status refused = choose_cohesive_laws(mesh);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().text.find("shear strength"), std::string::npos);
}

}  // namespace
}  // namespace selvage::fem
