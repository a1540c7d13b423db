// Meshes of unit cells against what the box and the yarns say by themselves.
#include "tetrahedra/cell_mesher.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "fem/quality.h"
#include "unit/fem/bodies.h"

namespace selvage::fem {
namespace {

fabric::Fabric fabric_with(const Vec3& low, const Vec3& high) {
  fabric::Fabric fabric;
  fabric.file = "cell.txt";
  fabric::Material epoxy;
  epoxy.name = "epoxy";
  epoxy.elastic = fabric::IsotropicElastic{3400, 0.35};
  fabric.materials.push_back(epoxy);
  fabric.cell.emplace();
  fabric.cell->low = low;
  fabric.cell->high = high;
  fabric.cell->matrix = "epoxy";
  return fabric;
}

using Sorted = std::array<std::size_t, 3>;

// Nodes of one face of the box, without the coordinate across it.
std::set<std::pair<double, double>> outline_of(const Mesh& mesh, int axis, double plane) {
  std::set<std::pair<double, double>> result;
  for (const Vec3& p : mesh.nodes)
    if (p[axis] == plane) result.emplace(p[(axis + 1) % 3], p[(axis + 2) % 3]);
  return result;
}

// Triangles of elements in a plane, as their corners' other coordinates.
std::set<std::array<std::pair<double, double>, 3>> triangles_in(const Mesh& mesh, int axis, double plane) {
  std::set<std::array<std::pair<double, double>, 3>> result;
  for (const auto& element : mesh.elements)
    for (std::size_t skip = 0; skip < 4; ++skip) {
      std::array<std::pair<double, double>, 3> corners;
      std::size_t n = 0;
      bool in_plane = true;
      for (std::size_t k = 0; k < 4; ++k) {
        if (k == skip) continue;
        const Vec3& p = mesh.nodes[element[k]];
        in_plane = in_plane && p[axis] == plane;
        corners[n++] = {p[(axis + 1) % 3], p[(axis + 2) % 3]};
      }
      std::sort(corners.begin(), corners.end());
      if (in_plane) result.insert(corners);
    }
  return result;
}

// Opposite faces alike to the bit; every inner side has two elements, every other is in a face of the box;
// the elements fill the box.
void expect_sound(const Mesh& mesh, const Box3& box, const std::array<bool, 3>& periodic) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!periodic[static_cast<std::size_t>(axis)]) continue;
    const auto low = outline_of(mesh, axis, box.min()[axis]), high = outline_of(mesh, axis, box.max()[axis]);
    EXPECT_GT(low.size(), 8);
    EXPECT_EQ(low, high);
    EXPECT_EQ(triangles_in(mesh, axis, box.min()[axis]), triangles_in(mesh, axis, box.max()[axis]));
  }
  std::map<Sorted, int> sides;
  double volume = 0;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    EXPECT_GT(shape_of(mesh, e).scaled_jacobian, 0);
    for (std::size_t skip = 0; skip < 4; ++skip) {
      Sorted side{};
      std::size_t n = 0;
      for (std::size_t k = 0; k < 4; ++k)
        if (k != skip) side[n++] = mesh.elements[e][k];
      std::sort(side.begin(), side.end());
      ++sides[side];
    }
  }
  for (const auto& [side, count] : sides) {
    ASSERT_LE(count, 2);
    if (count == 2) continue;
    bool on_box = false;
    for (int axis = 0; axis < 3; ++axis)
      for (const double plane : {box.min()[axis], box.max()[axis]})
        on_box = on_box || std::all_of(side.begin(), side.end(),
                                       [&](std::size_t k) { return mesh.nodes[k][axis] == plane; });
    EXPECT_TRUE(on_box);
  }
  std::size_t elements = 0;
  for (const Region& region : mesh.regions) {
    EXPECT_EQ(region.first_element, elements);
    elements = region.last_element;
    volume += region.volume;
  }
  EXPECT_EQ(elements, mesh.elements.size());
  if (mesh.order == 1) {
    EXPECT_NEAR(volume, box.volume(), 1e-9 * box.volume());
  }
}

Result<Mesh> mesh_of(const std::vector<yarn::Body>& bodies, const Box3& box, const CellMeshOptions& options) {
  const fabric::Fabric fabric = fabric_with(box.min(), box.max());
  Diagnostics diagnostics;
  return mesh_cell(fabric, bodies, options, diagnostics);
}

// The quadratic elements follow the yarn: their volume is the exact one's, nearly.
TEST(CellMesher, StraightYarnOfBothOrders) {
  const std::vector<yarn::Body> bodies = {test::straight_tube(0.8, 0.5, 4, 24, {-1.5, 0.5, 0.35})};
  const Box3 box(Vec3(0, 0, 0), Vec3(1, 1, 0.7));
  CellMeshOptions options;
  options.size = 0.1;
  options.periodic = {true, true, true};
  for (const int order : {1, 2}) {
    options.order = order;
    const Result<Mesh> mesh = mesh_of(bodies, box, options);
    ASSERT_TRUE(mesh.ok()) << to_string(mesh.error());
    expect_sound(*mesh, box, options.periodic);
    ASSERT_EQ(mesh->regions.size(), 2U);
    EXPECT_EQ(mesh->regions[0].kind, Region::Kind::yarn);
    EXPECT_EQ(mesh->regions[1].kind, Region::Kind::matrix);
    EXPECT_NEAR(mesh->regions[0].exact_volume, bodies[0].volume / 4, 1e-7);
    EXPECT_GE(mesh->quality.min_dihedral, 10);
    const double miss = order == 1 ? 1e-9 : 1e-4;
    EXPECT_NEAR(mesh->regions[0].volume, mesh->regions[0].exact_volume, miss * mesh->regions[0].exact_volume);
    for (std::size_t e = 0; e < mesh->regions[0].last_element; ++e) EXPECT_NEAR(mesh->along[e].x(), 1, 1e-9);
    EXPECT_EQ(mesh->load_cases.size(), 7U);
  }
}

// Yarns in the faces and on the edges of the box: halves and quarters that go on at the opposite sides.
TEST(CellMesher, YarnsCutLengthwise) {
  std::vector<yarn::Body> bodies;
  int number = 0;
  for (const double y : {0.0, 1.0})
    for (const double z : {0.0, 1.0})
      bodies.push_back(
          test::straight_tube(0.5, 0.5, 4, 24, {-1.5, y, z}, "corner" + std::to_string(++number)));
  bodies.push_back(test::straight_tube(0.3, 0.3, 4, 24, {-1.5, 0.5, 0}, "low"));
  bodies.push_back(test::straight_tube(0.3, 0.3, 4, 24, {-1.5, 0.5, 1}, "high"));
  const Box3 box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  CellMeshOptions options;
  options.size = 0.12;
  options.periodic = {true, true, true};
  const Result<Mesh> mesh = mesh_of(bodies, box, options);
  ASSERT_TRUE(mesh.ok()) << to_string(mesh.error());
  expect_sound(*mesh, box, options.periodic);
  ASSERT_EQ(mesh->regions.size(), 7U);
  for (std::size_t k = 0; k < 6; ++k)
    EXPECT_NEAR(mesh->regions[k].exact_volume, bodies[k].volume / 4 / (k < 4 ? 4 : 2), 1e-6);
  EXPECT_GE(mesh->quality.min_dihedral, 10);
}

// Two crossing yarns with a gap of 2 % of their height between them, one with its end inside the box.
TEST(CellMesher, ThinGapAndAnEndInside) {
  std::vector<yarn::Body> bodies = {test::straight_tube(0.5, 0.2, 2, 24, {0.2, 0.5, 0.25}, "ends")};
  bodies.push_back(test::grid_body("across", 24, 6, [](double angle, double share) {
    return Vec3(0.5 - 0.25 * std::cos(angle), 2 * share - 0.5, 0.4523 + 0.1 * std::sin(angle));
  }));
  const Box3 box(Vec3(0, 0, 0), Vec3(1, 1, 0.7));
  CellMeshOptions options;
  options.size = 0.1;
  const fabric::Fabric fabric = fabric_with(box.min(), box.max());
  Diagnostics diagnostics;
  options.periodic = {};
  const Result<Mesh> mesh = mesh_cell(fabric, bodies, options, diagnostics);
  ASSERT_TRUE(mesh.ok()) << to_string(mesh.error());
  expect_sound(*mesh, box, options.periodic);
  ASSERT_EQ(mesh->regions.size(), 3U);
  EXPECT_NEAR(mesh->regions[0].exact_volume, bodies[0].volume * 0.8 / 2, 1e-6);
  EXPECT_GT(mesh->regions[0].start_faces.size(), 10);
  EXPECT_TRUE(mesh->regions[0].end_faces.empty());
  EXPECT_GE(mesh->quality.min_dihedral, 10);
}

// Without a matrix the same yarns, cut flush, share nothing.
TEST(CellMesher, DryYarns) {
  const std::vector<yarn::Body> bodies = {test::straight_tube(0.4, 0.4, 4, 24, {-1.5, 0.5, 0.25}, "a"),
                                          test::straight_tube(0.4, 0.4, 4, 24, {-1.5, 0.5, 0.75}, "b")};
  CellMeshOptions options;
  options.size = 0.1;
  options.matrix = false;
  options.periodic = {true, true, false};
  const Result<Mesh> mesh = mesh_of(bodies, Box3(Vec3(0, 0, 0), Vec3(1, 1, 1)), options);
  ASSERT_TRUE(mesh.ok()) << to_string(mesh.error());
  ASSERT_EQ(mesh->regions.size(), 2U);
  std::set<std::size_t> first;
  for (std::size_t e = 0; e < mesh->regions[0].last_element; ++e)
    first.insert(mesh->elements[e].begin(), mesh->elements[e].begin() + 4);
  for (std::size_t e = mesh->regions[1].first_element; e < mesh->elements.size(); ++e)
    for (std::size_t k = 0; k < 4; ++k) EXPECT_FALSE(first.contains(mesh->elements[e][k]));
  EXPECT_EQ(outline_of(*mesh, 0, 0.0), outline_of(*mesh, 0, 1.0));
}

// A yarn that does not come in where it went out is named.
TEST(CellMesher, NotPeriodic) {
  const std::vector<yarn::Body> bodies = {test::grid_body("slanted", 24, 6, [](double angle, double share) {
    return Vec3(4 * share - 1.5, 0.5 + 0.2 * std::cos(angle) + 0.1 * share, 0.35 + 0.2 * std::sin(angle));
  })};
  CellMeshOptions options;
  options.size = 0.1;
  options.periodic = {true, true, false};
  const Result<Mesh> mesh = mesh_of(bodies, Box3(Vec3(0, 0, 0), Vec3(1, 1, 0.7)), options);
  ASSERT_FALSE(mesh.ok());
  EXPECT_EQ(mesh.error().kind, Kind::geometry);
  EXPECT_EQ(mesh.error().yarn, "slanted");
  EXPECT_TRUE(mesh.error().at.has_value());
}

// The same bytes with any number of threads.
TEST(CellMesher, SameWithAnyThreads) {
  const std::vector<yarn::Body> bodies = {test::straight_tube(0.4, 0.4, 4, 24, {-1.5, 0.5, 0.25}, "a"),
                                          test::straight_tube(0.4, 0.4, 4, 24, {-1.5, 0.5, 0.75}, "b")};
  const Box3 box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  CellMeshOptions options;
  options.size = 0.12;
  options.periodic = {true, true, true};
  const Result<Mesh> one = mesh_of(bodies, box, options);
  options.threads = 3;
  const Result<Mesh> three = mesh_of(bodies, box, options);
  ASSERT_TRUE(one.ok() && three.ok());
  EXPECT_EQ(one->nodes, three->nodes);
  EXPECT_EQ(one->elements, three->elements);
}

}  // namespace
}  // namespace selvage::fem
