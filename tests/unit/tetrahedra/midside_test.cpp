#include "tetrahedra/midside.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/module.h"
#include "fem/faces.h"
#include "fem/quality.h"
#include "surface_mesh/cell_size.h"
#include "surface_mesh/curved_edges.h"
#include "surface_mesh/skin.h"
#include "tetrahedra/block.h"
#include "tetrahedra/improve.h"
#include "tetrahedra/worker.h"
#include "unit/fem/bodies.h"

namespace selvage::fem {
namespace {

// A wave along x of three periods of 2.
yarn::Body wave() {
  return test::grid_body("wave", 24, 49, [](double angle, double share) {
    return Vec3(6 * share - 2, 0.4 * std::cos(angle),
                0.2 * std::sin(angle) + 0.15 * std::cos(6 * std::numbers::pi * share));
  });
}

// A yarn whose sections lean.
yarn::Body leaning() {
  return test::grid_body("leaning", 24, 8, [](double angle, double share) {
    const double z = 0.3 * std::sin(angle);
    return Vec3(2 * share + 0.4 * z + 0.1 * std::cos(angle), 0.4 * std::cos(angle), z);
  });
}

double distance_to(const yarn::Body& body, const Vec3& point) {
  const nurbs::Surface& s = body.surface;
  Vec2 best = Vec2::Zero();
  double least = 1e9;
  for (int i = 0; i < 200; ++i)
    for (int j = 0; j <= 200; ++j) {
      const Vec2 at(s.first_u() + (s.last_u() - s.first_u()) * i / 200,
                    s.first_v() + (s.last_v() - s.first_v()) * j / 200);
      const double far = (nurbs::evaluate(s, at.x(), at.y()) - point).norm();
      if (far < least) {
        least = far;
        best = at;
      }
    }
  double step = (s.last_u() - s.first_u()) / 200, step_v = (s.last_v() - s.first_v()) / 200;
  for (int turn = 0; turn < 60; ++turn, step /= 1.6, step_v /= 1.6)
    for (int i = -2; i <= 2; ++i)
      for (int j = -2; j <= 2; ++j) {
        Vec2 at = best + Vec2(i * step, j * step_v);
        const double round = s.last_u() - s.first_u();  // the search goes on beyond the seam
        at.x() -= round * std::floor((at.x() - s.first_u()) / round);
        const double far = (nurbs::evaluate(s, at.x(), at.y()) - point).norm();
        if (far >= least) continue;
        least = far;
        best = at;
      }
  return least;
}

// The one yarn of a cell without a matrix, which cuts one period out of it.
struct CellOfYarn {
  yarn::Body body = wave();
  Mesh mesh;
  std::optional<Block> block{};
  Box3 box{};  // mm
};

void fill(CellOfYarn& cell, double size) {
  const std::span<const yarn::Body> one(&cell.body, 1);
  const Box3 box(Vec3(0, -1, -1), Vec3(2, 1, 1));
  Result<Skin> skin = make_skin(
      one, box,
      cell_size_rules(one, std::span(&size, 1), 0, usual_growth, yarn::narrowest_section(cell.body)),
      {.tolerance = 1e-4, .miss = 1e-3, .periodic = {true, false, false}});
  ASSERT_TRUE(skin.ok()) << to_string(skin.error());
  cell.block.emplace(one, Unit::inch, box, std::array{true, false, false}, std::move(*skin));
  const CellTriangles& surface = cell.block->skin.surface;
  const std::vector<Vec3>& points = cell.block->skin.nodes.points;
  Result<TetMesh> tets = run_tetgen(find_worker("selvage-tetgen").value(),
                                    {.points = points, .triangles = surface.triangles}, {});
  ASSERT_TRUE(tets.ok());
  std::vector<std::uint32_t> regions(tets->cells.size(), 0);
  improve(tets->points, tets->cells, regions, points.size(),
          {.target = 18, .refine = RefineOptions{.max_volume = largest_volume(size)}});
  const double mm = 25.4;
  for (const Vec3& p : tets->points) cell.mesh.nodes.push_back(mm * p);
  for (const auto& t : tets->cells) cell.mesh.elements.push_back({t[0], t[1], t[2], t[3]});
  Region region;
  region.last_element = cell.mesh.elements.size();
  for (std::size_t k = 0; k < surface.triangles.size(); ++k)
    if (const Triangle& t = surface.triangles[k]; surface.parts[k] == CellTriangles::Part::side)
      region.side_faces.push_back({t[0], t[1], t[2], t[2]});  // for the test
  cell.mesh.regions.push_back(region);
  cell.box = Box3(Vec3(mm * box.min()), Vec3(mm * box.max()));
}

TEST(CellMidside, OffTheSurfaceByOneShareOnItInTheFacesAndOppositeOnesAlike) {
  CellOfYarn cell;
  fill(cell, 0.06);
  measure(cell.mesh);
  const double mm = 25.4, exact = cell.block->skin.volumes.front() * mm * mm * mm;
  const double straight = std::abs(cell.mesh.regions[0].volume - exact);
  const std::size_t corners = cell.mesh.nodes.size();
  const MidsideNodes nodes = add_midside_nodes(cell.mesh, *cell.block);
  EXPECT_EQ(nodes.held, 0U);
  EXPECT_EQ(nodes.farthest, 0);
  measure(cell.mesh);
  EXPECT_GT(straight, 1e-4 * exact);
  EXPECT_NEAR(cell.mesh.regions[0].volume, exact, 1e-8 * exact);
  EXPECT_GT(cell.mesh.quality.min_scaled_jacobian, 0.1);

  std::vector<Vec2> low, high;
  std::size_t looked_at = 0;
  for (const auto& element : cell.mesh.elements)
    for (std::size_t k = 4; k < 10; ++k) ASSERT_GE(element[k], corners);
  for (std::size_t p = corners; p < cell.mesh.nodes.size(); ++p) {
    const Vec3& at = cell.mesh.nodes[p];
    if (at.x() == cell.box.min().x()) low.emplace_back(at.y(), at.z());
    if (at.x() == cell.box.max().x()) high.emplace_back(at.y(), at.z());
  }
  const auto before = [](const Vec2& a, const Vec2& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  };
  std::sort(low.begin(), low.end(), before);
  std::sort(high.begin(), high.end(), before);
  EXPECT_GT(low.size(), 20U);
  // The caps' own triangulations are the same; so are the middles of all their edges.
  EXPECT_EQ(low, high);
  // Of the edges of the surface: in the faces the middles are on it, elsewhere they stand off by one share of
  // their heights over the chord (every sixtieth is looked at).
  struct Looked {
    Vec3 chord, middle;
    bool is_in_face;
  };
  std::vector<Looked> edges;
  const auto& sides = cell.mesh.regions[0].side_faces;
  for (const SixNodes& six : six_node_faces(cell.mesh, cell.mesh.regions[0], sides))
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& middle = cell.mesh.nodes[six[3 + k]];
      const bool is_in_face = middle.x() == cell.box.min().x() || middle.x() == cell.box.max().x();
      if (!is_in_face && ++looked_at % 60 != 0) continue;
      const Vec3 ends = cell.mesh.nodes[six[k]] + cell.mesh.nodes[six[(k + 1) % 3]];
      edges.push_back({ends / (2 * mm), middle / mm, is_in_face});
    }
  const auto height = [](const Looked& edge) {
    return edge.is_in_face ? 0 : (edge.middle - edge.chord).norm();
  };
  const Looked highest = *std::ranges::max_element(edges, {}, height);
  const double off = distance_to(cell.body, highest.middle);
  EXPECT_GT(off, 1e-7);
  // The share is small, and of either sign: the one that leads back to the surface.
  const auto back = [](const Looked& edge, double share) -> Vec3 {
    return edge.chord + (edge.middle - edge.chord) * (1 - share);
  };
  const auto in_faces = std::ranges::count_if(edges, &Looked::is_in_face);
  EXPECT_GE(in_faces, 20);
  EXPECT_GE(static_cast<std::ptrdiff_t>(edges.size()) - in_faces, 20);
  double share = off / height(highest);
  if (distance_to(cell.body, back(highest, share)) > off / 10) share = -share;
  EXPECT_LT(std::abs(share), 0.1);
  for (const Looked& edge : edges)
    EXPECT_LT(distance_to(cell.body, edge.is_in_face ? edge.middle : back(edge, share)), 1e-7);
}

// The middle of an edge in a face of the cell that cuts the yarn askew.
TEST(CellMidside, MiddleOfAnEdgeInAPlane) {
  const yarn::Body body = leaning();
  const nurbs::Surface& s = body.surface;
  const double plane = 1.03125;
  const auto end = [&](double u) {
    double low = s.first_v(), high = s.last_v();
    for (int k = 0; k < 100; ++k) {
      const double v = (low + high) / 2;
      (nurbs::evaluate(s, u, v).x() < plane ? low : high) = v;
    }
    SurfaceEnd result{{u, low}, nurbs::evaluate(s, u, low)};
    result.at.x() = plane;
    return result;
  };
  const double range = s.last_u() - s.first_u();
  for (int k = 0; k < 40; ++k) {
    // The last edge crosses the seam.
    const SurfaceEnd from = end(s.first_u() + range * k / 40),
                     to = end(s.first_u() + range * ((k + 1) % 40) / 40);
    const std::optional<Vec3> middle = middle_in_plane(body, from, to, Vec3::UnitX());
    ASSERT_TRUE(middle.has_value()) << k;
    EXPECT_EQ(middle->x(), plane);
    EXPECT_LT(distance_to(body, *middle), 1e-7) << k;
    const Vec3 chord = to.at - from.at;
    EXPECT_NEAR((*middle - (from.at + to.at) / 2).dot(chord), 0, 1e-10 * chord.squaredNorm());
    EXPECT_EQ(*middle_in_plane(body, to, from, Vec3::UnitX()), *middle) << k;
  }
}

// A step that would fold an element is taken back, and its tied opposite with it.
TEST(CellMidside, TakenBackTogether) {
  Mesh mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0.1}, {0, 0, 5}, {1, 0, 5}, {0, 1, 5}, {0, 0, 6}};
  mesh.elements = {{0, 1, 2, 3}, {4, 5, 6, 7}};
  mesh.regions.emplace_back();
  const Vec3 far(0, 0, 0.2);
  const std::array<CurvedEdge, 2> curved = {CurvedEdge{edge_key(0, 1), Vec3(0.5, 0, 0) + far},
                                            CurvedEdge{edge_key(4, 5), Vec3(0.5, 0, 5) + far}};
  const std::array<TiedEdges, 1> tied = {TiedEdges{curved[0].key, curved[1].key}};
  Mesh alone = mesh;
  EXPECT_EQ(add_midside_nodes(alone, curved, {}).held, 1U);
  const MidsideNodes together = add_midside_nodes(mesh, curved, tied);
  EXPECT_EQ(together.held, 2U);
  EXPECT_GT(together.farthest, 0.05);
  EXPECT_LE(together.farthest, 0.2 + 1e-12);
  const Vec3 step = mesh.nodes[mesh.elements[0][4]] - Vec3(0.5, 0, 0);
  EXPECT_EQ(mesh.nodes[mesh.elements[1][4]] - Vec3(0.5, 0, 5), step);
  for (std::size_t e = 0; e < 2; ++e) EXPECT_GT(shape_of(mesh, e).scaled_jacobian, 0);
}

}  // namespace
}  // namespace selvage::fem
