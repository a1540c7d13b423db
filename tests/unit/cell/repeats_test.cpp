// `cell repeat`: what so many repeats hold, and where the cell stands.
#include <gtest/gtest.h>

#include <numeric>

#include "built.h"
#include "cell/volume.h"
#include "construction/settle_cell.h"
#include "fabric_reading.h"
#include "formats/registry.h"

namespace selvage::cell {
namespace {

struct Settled {
  std::optional<fabric::Fabric> fabric;
  std::string said;
  std::vector<yarn::Body> bodies;

  [[nodiscard]] Box3 box() const { return {fabric->cell->low, fabric->cell->high}; }
};

Settled settle(const std::string& cloth, const std::string& cell, double gap = 0) {
  test::Reading reading =
      test::read(formats::txt::descriptor(),
                 Source::from_memory("fabric 1\nthread t\n diameter 0.2\nend\nthread flat\n section "
                                     "ellipse 0.9 0.2\nend\n" +
                                         cloth + cell + "\nend\n",
                                     "test.txt"));
  Settled settled;
  EXPECT_TRUE(reading.fabric.has_value()) << reading.text();
  if (!reading.fabric) return settled;
  fabric::BuildOptions options;
  options.gap = gap;
  Diagnostics diagnostics;
  fabric::settle_cell(*reading.fabric, options, 2, diagnostics);
  for (const Message& message : diagnostics.messages()) settled.said += to_string(message) + "\n";
  settled.fabric = std::move(reading.fabric);
  if (!diagnostics.has_errors()) settled.bodies = test::built(*settled.fabric, options);
  return settled;
}

// The share of the cell that is yarn.
double fraction(const Settled& settled) {
  const Result<Cut> pieces = cut(settled.bodies, settled.box(), 1e-4);
  EXPECT_TRUE(pieces.ok()) << (pieces.ok() ? "" : to_string(pieces.error()));
  if (!pieces) return 0;
  const Result<Division> division = divide_faces(settled.bodies, settled.box(), *pieces);
  EXPECT_TRUE(division.ok()) << (division.ok() ? "" : to_string(division.error()));
  if (!division) return 0;
  const std::vector<double> volumes = volumes_inside(settled.bodies, settled.box(), *pieces, *division);
  return std::accumulate(volumes.begin(), volumes.end(), 0.0) / settled.box().volume();
}

const std::string plain = "weave\nwarp flat 2 pitch 1.2\nweft flat 2 pitch 1.5\ndraft plain\nend\n";
const std::string twill = "weave\nwarp t 3 pitch 0.5\nweft t 6 pitch 0.6\ndraft twill 2/1\nend\n";
const std::string jersey = "knit jersey\nthread t\ncourses 2\nwales 2\nend\n";
const std::string tricot = "warpknit tricot\nthread t\nwales 4 pitch 1.8\ncourses 4 pitch 1.2\nend\n";
const std::string terry =
    "weave\nwarp t 2 pitch 0.8\nweft t 3 pitch 0.55\ndraft plain\npile 1 every 3\nend\n";
// Without room between its picks: tufts of all of them but the ground's end where a face would cut them.
const std::string corduroy =
    "thread s\n diameter 0.2\nend\nweave\nwarp t 6 pitch 0.5\nweft t,2s 6 pitch 0.22\ndraft corduroy "
    "6\nend\n";

// Yarn is everywhere alike: two repeats hold twice as much.
TEST(CellOfRepeats, SharesAreThoseOfOneRepeat) {
  for (const std::string& cloth : {plain, twill, jersey, tricot, terry, corduroy}) {
    SCOPED_TRACE(cloth);
    const Settled one = settle(cloth, "cell repeat"), two = settle(cloth, "cell repeat 2 x 1"),
                  other = settle(cloth, "cell repeat 1x2\nmargin 0.3");
    const Vec3 size = one.box().sizes(), twice = two.box().sizes();
    EXPECT_NEAR(twice.x(), 2 * size.x(), 1e-12);
    EXPECT_NEAR(twice.y(), size.y(), 1e-12);
    EXPECT_EQ(twice.z(), size.z());
    const double share = fraction(one);
    EXPECT_GT(share, 0.05);
    const double share_of_two = fraction(two);
    EXPECT_NEAR(share_of_two, share, 1e-9 * share);
    EXPECT_NEAR(fraction(other) * other.box().sizes().z(), share * size.z(), 1e-9 * share);
    EXPECT_TRUE(one.fabric->cell->periodic[0] && one.fabric->cell->periodic[1] &&
                !one.fabric->cell->periodic[2]);
  }
}

TEST(CellOfRepeats, IsTheRepeat) {
  const Settled cell = settle(plain, "cell repeat");
  EXPECT_LT((cell.box().min().head<2>() - Vec2(0, 0)).norm(), 1e-12);
  EXPECT_LT((cell.box().max().head<2>() - Vec2(3, 2.4)).norm(), 1e-12);
  // The same yarns fill a cell whose corners are written.
  const Settled written = settle(plain, "cell 0 0 -1  3 2.4 1\nperiodic x y");
  EXPECT_NEAR(fraction(cell) * cell.box().sizes().z(), fraction(written) * 2, 1e-8);
  // As high as the yarns, and a tenth of them more on both sides.
  double low = 0, high = 0;
  for (const yarn::Body& body : cell.bodies)
    for (const Vec3& p : nurbs::evaluate_grid(body.surface, {0.1, 0.2, 0.25, 0.3, 0.5, 0.7, 0.75, 0.8},
                                              {0.4, 0.45, 0.475, 0.5, 0.525, 0.55})) {
      low = std::min(low, p.z());
      high = std::max(high, p.z());
    }
  EXPECT_NEAR(cell.box().max().z(), high + 0.02, 0.005);
  EXPECT_NEAR(cell.box().min().z(), low - 0.02, 0.005);
  const Settled wide = settle(plain, "cell repeat\nmargin 0.5");
  EXPECT_NEAR(wide.box().max().z() - cell.box().max().z(), 0.48, 1e-9 + 2e-3);
}

// A cloth turned by a quarter, or sheared by half a right angle, has as much yarn in its cell.
TEST(CellOfRepeats, OfUsedBlocks) {
  const double share = fraction(settle(plain, "cell repeat"));
  const Settled turned = settle("block b\n" + plain + "end\nuse b\nrotate 90\nend\n", "cell repeat");
  EXPECT_NEAR(turned.box().sizes().x(), 2.4, 1e-12);
  EXPECT_NEAR(turned.box().sizes().y(), 3, 1e-12);
  EXPECT_NEAR(fraction(turned), share, 1e-7);
  // Of straight yarns that lean by 45 degrees: the same area, the same length of yarn times sqrt(2).
  const std::string tows =
      "block tow\nyarn y t\npath\n0 0 0\n20 0 0\nend\nend\nend\nblock ply\nuse tow\nrepeat 1 20 step 0 "
      "1\nend\nend\n";
  const Settled ply = settle(tows + "use ply\nshear y x 45\nend\n", "cell repeat");
  ASSERT_FALSE(ply.bodies.empty()) << ply.said;
  EXPECT_NEAR(ply.box().sizes().x(), 1, 1e-12);
  EXPECT_NEAR(ply.box().sizes().y(), 1, 1e-12);
  const double area = ply.bodies[0].end_area;
  EXPECT_NEAR(fraction(ply) * ply.box().volume(), std::sqrt(2.0) * area, 1e-7);
}

TEST(CellOfRepeats, SaysWhyNot) {
  EXPECT_NE(
      settle("yarn y t\npath\n0 0 0\n1 1 0\nend\nend\n", "cell repeat").said.find("not of yarns by hand"),
      std::string::npos);
  EXPECT_NE(
      settle("block b\n" + plain + "end\nuse b\nrotate 31\nend\n", "cell repeat").said.find("has no repeat"),
      std::string::npos);
  const Settled braid =
      settle("braid\nthread t\ncarriers 5\npattern 2/2\nflat\nangle 30\nlength 10\nend\n", "cell repeat");
  EXPECT_NE(braid.said.find("warning: the cloth has no repeat along y"), std::string::npos) << braid.said;
  EXPECT_FALSE(braid.bodies.empty());
}

}  // namespace
}  // namespace selvage::cell
