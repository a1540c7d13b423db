// The cells of the samples: what is cut from the yarns and the matrix fill the box.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "built.h"
#include "cell/volume.h"
#include "core/source.h"
#include "formats/registry.h"
#include "places.h"

namespace selvage::cell {
namespace {

struct BuiltCell {
  Box3 box;
  double tolerance = 0;
  std::vector<yarn::Body> bodies;
};

BuiltCell build(const std::filesystem::path& path) {
  BuiltCell built;
  Diagnostics diagnostics;
  Result<Source> source = Source::open(path);
  EXPECT_TRUE(source.ok());
  if (!source) return built;
  const std::optional<fabric::Fabric> fabric = formats::txt::descriptor().read_fabric(*source, diagnostics);
  EXPECT_TRUE(fabric && fabric->cell) << path;
  if (!fabric || !fabric->cell) return built;
  built.box = Box3(fabric->cell->low, fabric->cell->high);
  built.tolerance = fabric::tolerance_of(*fabric, {});
  built.bodies = test::built(*fabric);
  return built;
}

class CellSamples : public testing::TestWithParam<std::string> {};

TEST_P(CellSamples, CutAndDivide) {
  const BuiltCell cell = build(std::filesystem::path(places::samples()) / (GetParam() + ".txt"));
  const Result<Cut> cut_up = cut(cell.bodies, cell.box, cell.tolerance);
  ASSERT_TRUE(cut_up.ok()) << to_string(cut_up.error());
  const Result<Division> division = divide_faces(cell.bodies, cell.box, *cut_up);
  ASSERT_TRUE(division.ok()) << to_string(division.error());
  double yarns = 0;
  const std::vector<double> volumes = volumes_inside(cell.bodies, cell.box, *cut_up, *division);
  std::map<std::size_t, int> pieces;
  for (const Piece& piece : cut_up->pieces) ++pieces[piece.body];
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    EXPECT_EQ(volumes[i] > 0, pieces.count(i) > 0) << cell.bodies[i].name;
    EXPECT_LT(volumes[i], cell.bodies[i].volume);
    yarns += volumes[i];
  }
  EXPECT_GT(yarns, 0.05 * cell.box.volume());
  EXPECT_LT(yarns, 0.9 * cell.box.volume());
}

// A cell of one repeat holds as much of each warp, wherever the faces cut it.
TEST(Samples, WarpsOfATwillAreEqual) {
  const BuiltCell cell = build(std::filesystem::path(places::samples()) / "twill_cell.txt");
  const Result<Cut> cut_up = cut(cell.bodies, cell.box, cell.tolerance);
  ASSERT_TRUE(cut_up.ok());
  const Result<Division> division = divide_faces(cell.bodies, cell.box, *cut_up);
  ASSERT_TRUE(division.ok());
  const std::vector<double> volumes = volumes_inside(cell.bodies, cell.box, *cut_up, *division);
  ASSERT_EQ(volumes.size(), 8U);
  for (const double volume : volumes) EXPECT_NEAR(volume, volumes[0], 1e-7 * volumes[0]);
}

INSTANTIATE_TEST_SUITE_P(All, CellSamples,
                         testing::Values("cell_plain", "twill_cell", "cell_satin5", "cell_orthogonal",
                                         "cell_jersey", "cell_tricot", "cell_straight", "cell_fibre",
                                         "cell_glass"));

}  // namespace
}  // namespace selvage::cell
