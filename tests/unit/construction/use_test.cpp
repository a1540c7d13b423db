// Used blocks: rigid maps move control points and nothing else, shears move centre lines and nothing else.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "built.h"
#include "fabric/inside.h"
#include "fabric_reading.h"
#include "formats/registry.h"
#include "nurbs/samples.h"
#include "yarn/body.h"
#include "yarn/finish.h"

namespace selvage::fabric {
namespace {

using std::numbers::pi;

const std::string head =
    "fabric 1\nthread t\n diameter 0.5\nend\nthread flat\n section ellipse 1 0.3\n twist 100 Z\nend\nthread "
    "odd\n "
    "section polygon\n -0.3 -0.2\n 0.5 -0.1\n 0.1 0.3\n end\n twist 60 Z rotate\nend\n";
const std::string cloth_text =
    "weave\nwarp flat 3 pitch 1.5\nweft t 2 pitch 1.2\ndraft plain\nend\nyarn y odd\npath\n0 0 2\n1 0.5 "
    "2.4\n2 0 2\n4 1 "
    "2\nend\nend\n";

test::Reading read(const std::string& text) {
  return test::read(formats::txt::descriptor(), Source::from_memory(head + text, "test.txt"));
}

std::vector<yarn::Body> bodies(const std::string& text) {
  const test::Reading reading = read(text);
  EXPECT_TRUE(reading.fabric.has_value()) << reading.text();
  return reading.fabric ? test::built(*reading.fabric) : std::vector<yarn::Body>{};
}

std::string used(const std::string& content, const std::string& lines, const std::string& header = "") {
  return "block b\n" + content + "end\nuse b" + header + "\n" + lines + "\nend\n";
}

// What building says of a text that can be read.
std::string refusal(const std::string& text) {
  const test::Reading reading = read(text);
  if (!reading.fabric) return reading.text();
  Diagnostics diagnostics;
  EXPECT_FALSE(YarnBuilder::create(*reading.fabric, {}, diagnostics).has_value());
  return diagnostics.first_error() != nullptr ? to_string(*diagnostics.first_error()) : "";
}

double to_segment(const Vec3& p, const Vec3& from, const Vec3& way) {
  return (p - from).cross(way.normalized()).norm();
}

// Every control point of a rotated or mirrored cloth is that of the cloth as it stands, mapped.
TEST(Uses, RigidMapsAreExact) {
  const std::vector<yarn::Body> plain = bodies(cloth_text);
  const double s = std::sin(30 * pi / 180), c = std::cos(30 * pi / 180);
  Eigen::Matrix3d turn;
  turn << 1, 0, 0, 0, c, -s, 0, s, c;
  const Vec3 shift(0.25, -3, 7);
  const std::vector<yarn::Body> turned = bodies(used(cloth_text, "rotate x 30\nplace 0.25 -3 7"));
  ASSERT_EQ(turned.size(), plain.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_EQ(turned[i].name, "b." + plain[i].name);
    EXPECT_EQ(turned[i].role, plain[i].role);
    ASSERT_EQ(turned[i].surface.points.size(), plain[i].surface.points.size());
    EXPECT_EQ(turned[i].surface.knots_v, plain[i].surface.knots_v);
    for (std::size_t k = 0; k < plain[i].surface.points.size(); ++k)
      EXPECT_LT((turned[i].surface.points[k] - (turn * plain[i].surface.points[k] + shift)).norm(), 1e-14);
    EXPECT_EQ(turned[i].volume, plain[i].volume);
    EXPECT_EQ(turned[i].twist, plain[i].twist);
    EXPECT_LT(yarn::end_gap(turned[i], false), 1e-14);
  }
}

// Four quarter turns about any axis come back to the bit.
TEST(Uses, QuarterTurnsAreExact) {
  const std::vector<yarn::Body> plain = bodies(cloth_text),
                                turned = bodies(
                                    used(cloth_text, "rotate z 90\nrotate x 90\nrotate y -90\nrotate z 270"));
  for (const std::string axis : {"x", "y", "z"}) {
    const std::string quarter = "rotate " + axis + " 90\n";
    const std::vector<yarn::Body> round =
        bodies(used(cloth_text, quarter + quarter + "rotate " + axis + " -180\n"));
    for (std::size_t i = 0; i < plain.size(); ++i) EXPECT_EQ(round[i].surface, plain[i].surface);
  }
  for (std::size_t i = 0; i < plain.size(); ++i) EXPECT_EQ(turned[i].volume, plain[i].volume);
}

// A mirror's image: other hand, normals out of the yarn, faces that still close it.
TEST(Uses, MirrorsKeepNormalsOutward) {
  const std::vector<yarn::Body> plain = bodies(cloth_text);
  for (const std::string sealing : {"patch", "fan", "planar"})
    for (const int axis : {0, 1, 2}) {
      BuildOptions options;
      options.ends = sealing == "patch" ? yarn::EndStyle::patch
                     : sealing == "fan" ? yarn::EndStyle::fan
                                        : yarn::EndStyle::planar;
      const test::Reading reading = read(used(cloth_text, std::string("mirror ") + "xyz"[axis]));
      ASSERT_TRUE(reading.fabric.has_value()) << reading.text();
      for (const yarn::Body& body : test::built(*reading.fabric, options)) {
        const auto original = std::find_if(plain.begin(), plain.end(),
                                           [&](const yarn::Body& b) { return "b." + b.name == body.name; });
        ASSERT_NE(original, plain.end());
        EXPECT_FALSE(body.inward);
        EXPECT_EQ(body.twist, -original->twist);
        EXPECT_LT(yarn::end_gap(body, false), 1e-14) << sealing;
        EXPECT_LT(yarn::end_gap(body, true), 1e-14);
        // By the divergence theorem, of the surfaces as they are.
        yarn::Body again = body;
        ASSERT_TRUE(yarn::finish_as_sealed(again).ok());
        EXPECT_FALSE(again.inward);
        EXPECT_EQ(again.start.inward, body.start.inward) << sealing << axis;
        EXPECT_NEAR(again.volume, original->volume, sealing == "patch" ? 1e-12 : 1e-3);
        for (std::size_t q = 1; q < 4; ++q) EXPECT_GT(body.quarters[q], body.quarters[q - 1]);
        // The same points as a set.
        const auto mirrored = [&](Vec3 p) {
          p[axis] = -p[axis];
          return p;
        };
        const int last = body.surface.count_u - 1;
        EXPECT_EQ(body.surface.point(1, 2), mirrored(original->surface.point(last - 1, 2)));
      }
    }
}

// A shear moves the centre line; the section stays a circle of the same size across it.
TEST(Uses, ShearMovesLinesOnly) {
  const std::string straight = "yarn y t\npath\n0 0 0\n0 4 0\nend\nend\n";
  const std::vector<yarn::Body> sheared = bodies(used(straight, "shear 45\nplace 1 2 3"));
  ASSERT_EQ(sheared.size(), 1U);
  const Vec3 from(1, 2, 3), way(1, 1, 0);
  EXPECT_NEAR(sheared[0].length, 4 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(sheared[0].volume, 4 * std::sqrt(2.0) * pi * 0.25 * 0.25, 2e-3);
  const nurbs::Surface& s = sheared[0].surface;
  for (const Vec3& p : nurbs::evaluate_grid(s, {0.03, 0.2, 0.5, 0.77}, {0, 0.4, 1}))
    EXPECT_NEAR(to_segment(p, from, way), 0.25, sheared[0].tube_error + 1e-12);
  // Any other way of saying it: along y by x.
  EXPECT_NEAR(
      bodies(used("yarn y t\npath\n0 0 0\n4 0 0\nend\nend\n", "shear y x -45"))[0].axis.points.back().y(), -4,
      1e-12);
}

TEST(Uses, ShearedPliesStayRoundTheirYarn) {
  const std::string text = "thread two\n diameter 0.5\n plies 2 300 S\nend\n" +
                           used("yarn y two\npath\n0 0 0\n0 4 0\nend\nend\n", "shear 45");
  const std::vector<yarn::Body> plies = bodies(text);
  ASSERT_EQ(plies.size(), 2U);
  EXPECT_EQ(plies[0].name, "b.y.ply1");
  EXPECT_EQ(plies[0].group, "b.y");
  const double first = to_segment(plies[0].axis.points.front(), Vec3::Zero(), {1, 1, 0});
  EXPECT_NEAR(first, 0.125, 0.005);
  for (double t = 0; t <= 1; t += 0.1)
    EXPECT_NEAR(to_segment(nurbs::evaluate(plies[1].axis, t), Vec3::Zero(), {1, 1, 0}), first, 1e-5);
}

// Mirrored and sheared at once: the image of what is sheared the other way.
TEST(Uses, MirroredShear) {
  const std::vector<yarn::Body> one = bodies(used(cloth_text, "shear 20\nmirror x")),
                                other = bodies(used(cloth_text, "shear -20"));
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_FALSE(one[i].inward);
    EXPECT_NEAR(one[i].length, bodies(used(cloth_text, "shear 20"))[i].length, 1e-9);
    EXPECT_GT(one[i].volume, 0);
  }
}

TEST(Uses, NestedAreOneMap) {
  const std::string nested =
      "block a\n" + cloth_text +
      "end\nblock b\nuse a as left\nrotate z 25\nend\nuse a as right\nshear 10\nend\nend\n"
      "use b\nmirror y\nplace 1 2 3\nend\n";
  const std::string flat =
      "block a\n" + cloth_text +
      "end\nuse a as b.left\nrotate z 25\nmirror y\nplace 1 2 3\nend\nuse a as b.right\nshear "
      "10\nmirror y\nplace 1 2 3\nend\n";
  const std::vector<yarn::Body> one = bodies(nested), other = bodies(flat);
  ASSERT_EQ(one.size(), other.size());
  ASSERT_EQ(one.size(), 2 * bodies(cloth_text).size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].name, other[i].name);
    EXPECT_EQ(one[i].surface, other[i].surface);
    EXPECT_EQ(one[i].place.line, other[i].place.line > 0 ? one[i].place.line : -1);
  }
}

TEST(Uses, RepeatsBeforeItMoves) {
  const std::vector<yarn::Body> all = bodies(used(cloth_text, "repeat 3 2 step 5 4\nrotate 90"));
  const std::vector<yarn::Body> plain = bodies(cloth_text);
  ASSERT_EQ(all.size(), 6 * plain.size());
  EXPECT_EQ(all[plain.size()].name, "b.2-1." + plain[0].name);
  const Vec3 step = all[plain.size()].surface.points[0] - all[0].surface.points[0];
  EXPECT_LT((step - Vec3(0, 5, 0)).norm(), 1e-12);
  EXPECT_EQ(all[0].shape, all[plain.size()].shape);
  EXPECT_NE(all[0].shape, 0U);
  // A construction steps by its own repeat.
  const std::vector<yarn::Body> weaves =
      bodies(used("weave\nwarp t 2 pitch 1\nweft t 2 pitch 1\ndraft plain\nend\n", "repeat 1 2"));
  ASSERT_EQ(weaves.size(), 8U);
  EXPECT_EQ(weaves[4].name, "b.2.warp_1");
  EXPECT_NEAR(weaves[4].axis.points[0].y() - weaves[0].axis.points[0].y(), 2.0, 1e-12);
}

TEST(Uses, NamesAreTheirOwn) {
  const std::string text =
      "block b\n" + cloth_text + "end\nuse b\nend\nuse b\nplace 0 0 5\nend\nuse b as top\nplace 0 0 9\nend\n";
  const std::vector<yarn::Body> all = bodies(text);
  const std::size_t n = all.size() / 3;
  EXPECT_EQ(all[0].name, "b.warp_1");
  EXPECT_EQ(all[n].name, "b_2.warp_1");
  EXPECT_EQ(all[2 * n].name, "top.warp_1");
}

// What a block means is decided where it stands, not where it is used.
TEST(Uses, NamesAreThoseRoundTheBlock) {
  const std::vector<yarn::Body> all = bodies(
      "block a\nyarn y t\npath\n0 0 0\n1 0 0\nend\nend\nend\nblock b\nthread t\ndiameter 0.1\nend\nuse "
      "a\nend\nyarn z "
      "t\npath\n0 3 0\n1 3 0\nend\nend\nend\nuse b\nend\n");
  ASSERT_EQ(all.size(), 2U);
  EXPECT_NEAR(all[0].volume, pi / 4 * 0.25, 1e-3);
  EXPECT_NEAR(all[1].volume, pi / 4 * 0.01, 1e-4);
}

TEST(Uses, EditsOfABlock) {
  const std::string yarn = "yarn y t\npath\n0 0 0\n1 0 0\n2 0 0\n3 0 0\nend\nend\n";
  const std::vector<yarn::Body> all =
      bodies(used(yarn + "edit y point 2 to 1 0.3 0\n", "repeat 2 1 step 5 0"));
  ASSERT_EQ(all.size(), 2U);
  EXPECT_GT(all[1].length, 3.01);
  EXPECT_NE(refusal(used(yarn, "") + "edit b.y point 2 to 1 0.3 0\n").find("one of a block"),
            std::string::npos);
}

TEST(Uses, RefusesWhatCannotBe) {
  EXPECT_NE(refusal("block a\nuse b\nend\nend\nblock b\nuse a\nend\nend\nuse a\nend\n")
                .find("in a circle: 'a' uses 'b' uses 'a'"),
            std::string::npos);
  EXPECT_NE(refusal("block a\nuse a\nend\nend\nuse a\nend\n").find("circle"), std::string::npos);
  EXPECT_NE(refusal(used("yarn y t\npath\n0 0 0\n1 1 0\nend\nend\n", "repeat 2 1"))
                .find("no repeat of its own along x"),
            std::string::npos);
  EXPECT_NE(refusal(used("yarn y t\npath\n0 0 0\n1 1 0\nend\nend\n", "repeat 1000 1001 step 1 1"))
                .find("copies of blocks"),
            std::string::npos);
  EXPECT_NE(refusal("yarn b.y t\npath\n0 0 0\n1 0 0\nend\nend\n" +
                    used("yarn y t\npath\n0 0 0\n1 0 0\nend\nend\n", "place 0 0 1"))
                .find("'as' gives"),
            std::string::npos);
  EXPECT_NE(
      refusal("material m\ndensity 1\nend\n" +
              used("material m\ndensity 2\nend\nyarn y t\nmaterial m\npath\n0 0 0\n1 0 0\nend\nend\n", ""))
          .find("'m' is another one elsewhere"),
      std::string::npos);
  // Two to the sixtieth copies.
  std::string many = "block b0\n" + cloth_text + "end\n";
  for (int i = 1; i <= 60; ++i)
    many += fmt::format("block b{}\nuse b{}\nend\nuse b{}\nend\nend\n", i, i - 1, i - 1);
  EXPECT_NE(refusal(many + "use b60\nend\n").find("copies of blocks"), std::string::npos);
}

TEST(Uses, AGridIsNotSheared) {
  const std::string grid =
      "yarn g\ngrid 2 4\n0 -1 -1\n0 1 -1\n0 1 1\n0 -1 1\n3 -1 -1\n3 1 -1\n3 1 1\n3 -1 1\nend\nend\n";
  EXPECT_NEAR(bodies(used(grid, "rotate 30"))[0].volume, bodies(grid)[0].volume, 0);
  const test::Reading reading = read(used(grid, "shear 10"));
  ASSERT_TRUE(reading.fabric.has_value());
  Diagnostics diagnostics;
  const auto builder = YarnBuilder::create(*reading.fabric, {}, diagnostics);
  ASSERT_TRUE(builder.has_value());
  const Result<yarn::Body> body = builder->build(0);
  ASSERT_FALSE(body.ok());
  EXPECT_NE(to_string(body.error()).find("no centre line to shear"), std::string::npos);
}

void expect_near(const Repeat& repeat, std::array<double, 3> wanted) {  // below 0: none
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(repeat[k].has_value(), wanted[k] >= 0) << k;
    if (!repeat[k]) continue;
    EXPECT_NEAR(*repeat[k], wanted[k], 1e-12) << k;
  }
}

TEST(PlacedRepeats, OfLattices) {
  const auto placed = [](const Repeat& own, const std::string& lines) {
    const test::Reading reading = read(used(cloth_text, lines));
    EXPECT_TRUE(reading.fabric.has_value()) << reading.text();
    return placed_repeat(own, placement_of(std::get<Use>(reading.fabric->items.back()).moves).linear);
  };
  const Repeat square = {2.0, 2.0, std::nullopt}, tows = {0.0, 3.0, std::nullopt};
  expect_near(placed(square, "rotate 45"), {2 * std::sqrt(2.0), 2 * std::sqrt(2.0), -1});
  expect_near(placed(square, "rotate 90"), {2, 2, -1});
  expect_near(placed(square, "rotate 30"), {-1, -1, -1});
  expect_near(placed(square, "shear 45"), {2, 2, -1});
  expect_near(placed(Repeat{2.0, 1.0, std::nullopt}, "shear 45"), {2, 2, -1});
  expect_near(placed(square, "rotate x 90"), {2, -1, 2});
  expect_near(placed(tows, "rotate 30"), {6, 2 * std::sqrt(3.0), -1});
  expect_near(placed(tows, "rotate 90"), {3, 0, -1});
}

}  // namespace
}  // namespace selvage::fabric
