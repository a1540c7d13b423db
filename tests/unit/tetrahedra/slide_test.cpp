// Points that slide along two crossing yarns: volumes by the divergence theorem, places by the surface.
#include "tetrahedra/slide.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <stdexcept>
#include <vector>

#include "core/module.h"
#include "fem/quality.h"
#include "surface_mesh/cell_size.h"
#include "unit/fem/bodies.h"

namespace selvage::fem {
namespace {

struct Crossing {
  std::vector<yarn::Body> bodies = {test::straight_tube(0.5, 0.2, 2, 24, {-0.5, 0.5, 0.25}, "along"),
                                    test::grid_body("across", 24, 6, [](double angle, double share) {
                                      return Vec3(0.5 - 0.25 * std::cos(angle), 2 * share - 0.5,
                                                  0.47 + 0.1 * std::sin(angle));
                                    })};
  std::optional<Block> block;
  TetMesh tets;

  Crossing() {
    const Parallelepiped cell(Box3(Vec3(0, 0, 0), Vec3(1, 1, 0.7)));
    const std::vector<double> sizes(2, 0.1);
    Result<Skin> skin = make_skin(bodies, cell, cell_size_rules(bodies, sizes, 0, usual_growth, 0.2),
                                  {.tolerance = 2e-4, .miss = 2e-3, .matrix = true});
    if (!skin) throw std::runtime_error(to_string(skin.error()));
    block.emplace(bodies, Unit::mm, cell, std::array<bool, 3>{}, std::move(*skin));
    Result<TetMesh> filled = fill(*block, {}, 0.1, {}, *find_worker("selvage-tetgen"));
    if (!filled) throw std::runtime_error(to_string(filled.error()));
    tets = std::move(*filled);
  }
  [[nodiscard]] std::map<std::uint32_t, double> volumes() const {
    std::map<std::uint32_t, double> result;
    for (std::size_t c = 0; c < tets.cells.size(); ++c) {
      const auto& [a, b, d, e] = tets.cells[c];
      const Vec3& p = tets.points[a];
      const double six = (tets.points[b] - p).cross(tets.points[d] - p).dot(tets.points[e] - p);
      EXPECT_GT(six, 0);
      result[tets.regions[c]] += six / 6;
    }
    return result;
  }
  // The smallest angle of each tetrahedron, increasing.
  [[nodiscard]] std::vector<double> angles() const {
    std::vector<double> result;
    for (const auto& t : tets.cells)
      result.push_back(shape_of({tets.points[t[0]], tets.points[t[1]], tets.points[t[2]], tets.points[t[3]]})
                           .min_dihedral);
    std::sort(result.begin(), result.end());
    return result;
  }
};

TEST(Slide, VolumesStayAndAnglesGrow) {
  Crossing crossing;
  const auto volumes = crossing.volumes();
  const std::vector<double> angles = crossing.angles();
  const std::vector<Vec3> before = crossing.tets.points;
  EXPECT_GT(slide_points(crossing.tets, *crossing.block, 25, false), 50U);
  const auto after = crossing.volumes();
  ASSERT_EQ(after.size(), 3U);
  for (const auto& [region, volume] : volumes) EXPECT_NEAR(after.at(region), volume, 1e-12) << region;
  const std::vector<double> new_angles = crossing.angles();
  EXPECT_GE(new_angles.front(), angles.front());
  EXPECT_GT(new_angles[angles.size() / 50], angles[angles.size() / 50] + 0.5);
  // Corners of the box's triangles and of the yarns' ends stay.
  const CellTriangles& surface = crossing.block->skin.surface;
  for (std::size_t k = 0; k < surface.triangles.size(); ++k) {
    if (surface.parts[k] == CellTriangles::Part::side) continue;
    for (const std::uint32_t p : surface.triangles[k]) EXPECT_EQ(crossing.tets.points[p], before[p]);
  }
}

TEST(Slide, OnTheSurface) {
  Crossing crossing;
  const std::vector<Vec3> before = crossing.tets.points;
  ASSERT_GT(slide_points(crossing.tets, *crossing.block, 25, true), 50U);
  double farthest = 0;
  for (std::size_t k = 0; k < crossing.block->skin.nodes.places.size(); ++k) {
    farthest = std::max(farthest, (crossing.tets.points[k] - before[k]).norm());
    const SurfacePlace& place = crossing.block->skin.nodes.places[k];
    if (place.body == no_body) continue;
    const Vec3 exact =
        nurbs::evaluate(crossing.bodies[place.body].surface, place.parameters.x(), place.parameters.y());
    EXPECT_LT((exact - crossing.tets.points[k]).norm(), 1e-9);
  }
  EXPECT_GT(farthest, 1e-3);
}

}  // namespace
}  // namespace selvage::fem
