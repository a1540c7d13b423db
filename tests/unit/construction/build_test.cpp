// From the model to bodies: sizes, units, warnings, refusals.
#include "construction/build.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fabric/yarn_spec.h"

namespace selvage::fabric {
namespace {

using std::numbers::pi;

Thread cotton() {
  Thread thread;
  thread.name = "cotton30";
  thread.linear_density = LinearDensity{30, LinearDensity::Measure::tex};
  thread.density = 1.52;
  thread.packing = 0.75;
  return thread;
}

Yarn straight(std::string name, double length) {
  Yarn yarn;
  yarn.name = std::move(name);
  yarn.thread = "cotton30";
  yarn.place = {7, 1};
  Path path;
  path.place = {8, 3};
  path.points = {{0, 0, 0}, {length, 0, 0}};
  yarn.shape = path;
  return yarn;
}

Fabric fabric_of(const Thread& thread, const Yarn& yarn, Unit units = Unit::mm) {
  Fabric fabric;
  fabric.file = "test.txt";
  fabric.units = units;
  fabric.threads = {thread};
  fabric.items = {yarn};
  return fabric;
}

Result<yarn::Body> build(const Fabric& fabric, Diagnostics& diagnostics, BuildOptions options = {}) {
  const std::optional<YarnBuilder> builder = YarnBuilder::create(fabric, options, diagnostics);
  if (!builder) return *diagnostics.first_error();
  return builder->build(0);
}

TEST(BuildTest, DiameterOfThirtyTexCottonIsThePublishedOneInEveryUnit) {
  EXPECT_NEAR(yarn_diameter(30, 1.52, 0.75), 0.03568 * std::sqrt(30 / (1.52 * 0.75)), 2e-5);
  EXPECT_NEAR(yarn_diameter(30, 1.52, 0.75), 0.1830, 5e-5);
  for (Unit unit : all_units) {
    const double mm = millimetres_per(unit);
    const Fabric fabric = fabric_of(cotton(), straight("y", 10 / mm), unit);
    Diagnostics diagnostics;
    BuildOptions options;
    options.full_digits = true;
    const Result<yarn::Body> body = build(fabric, diagnostics, options);
    ASSERT_TRUE(body.ok()) << to_string(body.error());
    // tex over density and packing is the section's area in 1/1000 mm2.
    EXPECT_NEAR(body->volume * mm * mm * mm, 10 * 30 / (1000 * 1.52 * 0.75), 1e-12);
    EXPECT_TRUE(diagnostics.messages().empty());
  }
}

TEST(BuildTest, DenierAndCottonCount) {
  EXPECT_NEAR((LinearDensity{270, LinearDensity::Measure::denier}.tex()), 30, 1e-12);
  EXPECT_NEAR((LinearDensity{19.7, LinearDensity::Measure::ne}.tex()), 590.541 / 19.7, 1e-4);
  // Half as heavy in any measure: of a single yarn of two plies.
  for (const auto measure :
       {LinearDensity::Measure::tex, LinearDensity::Measure::dtex, LinearDensity::Measure::denier,
        LinearDensity::Measure::nm, LinearDensity::Measure::ne}) {
    const LinearDensity whole{30, measure};
    EXPECT_NEAR(whole.times(0.5).tex(), 0.5 * whole.tex(), 1e-12);
    EXPECT_EQ(whole.times(0.5).measure, measure);
  }
}

TEST(BuildTest, DefaultToleranceIsAThousandthOfTheSmallestSize) {
  Thread tow = cotton();
  tow.section = yarn::Ellipse{0.8, 0.2};
  Fabric fabric = fabric_of(tow, straight("y", 3));
  EXPECT_DOUBLE_EQ(tolerance_of(fabric, {}), 0.2e-3);
  fabric.tolerance = 0.01;
  EXPECT_EQ(tolerance_of(fabric, {}), 0.01);
  BuildOptions options;
  options.tolerance = 0.005;
  EXPECT_EQ(tolerance_of(fabric, options), 0.005);
}

TEST(BuildTest, MoreFibreThanSectionIsAWarningOnce) {
  Thread thin = cotton();
  thin.diameter = 0.0912;  // the published radius, taken for a diameter
  Fabric fabric = fabric_of(thin, straight("a", 3));
  fabric.items.emplace_back(straight("b", 3));
  Diagnostics diagnostics;
  ASSERT_TRUE(YarnBuilder::create(fabric, {}, diagnostics).has_value());
  ASSERT_EQ(diagnostics.messages().size(), 1U);
  const Message& message = diagnostics.messages().front();
  EXPECT_EQ(message.severity, Severity::warning);
  EXPECT_NE(message.text.find("3.02"), std::string::npos) << message.text;  // 30 / (1000 1.52 pi/4 0.0912^2)
  EXPECT_NE(message.text.find("cotton30"), std::string::npos);
}

TEST(BuildTest, PackingThatTheSizeContradictsIsAWarning) {
  Thread thread = cotton();
  thread.diameter = 0.2;
  Diagnostics diagnostics;
  ASSERT_TRUE(YarnBuilder::create(fabric_of(thread, straight("a", 3)), {}, diagnostics).has_value());
  ASSERT_EQ(diagnostics.messages().size(), 1U);
  EXPECT_NE(diagnostics.messages().front().text.find("0.628"), std::string::npos)
      << diagnostics.messages().front().text;
}

TEST(BuildTest, AThreadWithoutSizeSaysWhatIsMissing) {
  Thread thread;
  thread.name = "cotton30";
  thread.linear_density = LinearDensity{30, LinearDensity::Measure::tex};
  Diagnostics diagnostics;
  const Result<yarn::Body> body = build(fabric_of(thread, straight("y", 3)), diagnostics);
  ASSERT_FALSE(body.ok());
  EXPECT_EQ(body.error().file, "test.txt");
  EXPECT_EQ(body.error().place.line, 7);
  EXPECT_NE(body.error().text.find("`density`"), std::string::npos);
  EXPECT_NE(body.error().text.find("`packing`"), std::string::npos);
  EXPECT_EQ(body.error().text.find("`tex`"), std::string::npos);
}

TEST(BuildTest, AnEditOfAYarnThatIsNotThereNamesTheNearest) {
  Fabric fabric = fabric_of(cotton(), straight("weft1", 3));
  Edit edit;
  edit.yarn = "weft2";
  edit.place = {40, 1};
  fabric.edits.push_back(edit);
  Diagnostics diagnostics;
  EXPECT_FALSE(YarnBuilder::create(fabric, {}, diagnostics).has_value());
  ASSERT_EQ(diagnostics.messages().size(), 1U);
  EXPECT_EQ(diagnostics.messages().front().place.line, 40);
  EXPECT_NE(diagnostics.messages().front().text.find("did you mean 'weft1'"), std::string::npos);
}

TEST(BuildTest, TwistTurnsPerMetreInEveryUnit) {
  for (Unit unit : all_units) {
    const double mm = millimetres_per(unit);
    Thread tow = cotton();
    tow.packing.reset();
    tow.linear_density.reset();
    tow.section = yarn::Ellipse{0.8 / mm, 0.2 / mm};
    tow.twist = Twist{40, Hand::s, true};
    Diagnostics diagnostics;
    const Result<yarn::Body> body = build(fabric_of(tow, straight("y", 12.5 / mm), unit), diagnostics);
    ASSERT_TRUE(body.ok()) << to_string(body.error());
    // 40 turns a metre over 12.5 mm: half a turn, so a quarter in the middle; S is left-handed: across (+y)
    // goes to -z.
    const Vec3 middle = nurbs::evaluate(body->surface, 0.0, 0.5) * mm;
    EXPECT_LT((middle - Vec3(6.25, 0, -0.4)).norm(), 4e-4) << name_of(unit);
  }
}

TEST(BuildTest, TenMillionPointsAreALimitErrorNotAnExhaustedMemory) {
  Yarn yarn = straight("long", 3);
  Path& path = std::get<Path>(yarn.shape);
  path.points.clear();
  for (int i = 0; i < 10'000'000; ++i) path.points.emplace_back(i, 0, 0);
  Diagnostics diagnostics;
  const Result<yarn::Body> body = build(fabric_of(cotton(), yarn), diagnostics);
  ASSERT_FALSE(body.ok());
  EXPECT_EQ(body.error().kind, Kind::limit);
  EXPECT_NE(body.error().text.find("10000000 points"), std::string::npos);
}

TEST(BuildTest, EqualPointsAreReportedAtTheirLine) {
  Yarn yarn = straight("y", 3);
  std::get<Path>(yarn.shape).points.emplace_back(3, 0, 0);
  Diagnostics diagnostics;
  const Result<yarn::Body> body = build(fabric_of(cotton(), yarn), diagnostics);
  ASSERT_FALSE(body.ok());
  EXPECT_EQ(body.error().place.line, 11);
}

TEST(BuildTest, PolylineCornersUseTheSectionInThePlaneOfTheBend) {
  // A flat section bends over its thickness at the first corner and over its width at the second.
  Thread tow = cotton();
  tow.section = yarn::Ellipse{0.8, 0.2};
  Yarn yarn = straight("y", 3);
  Path& path = std::get<Path>(yarn.shape);
  path.form = yarn::PathForm::polyline;
  path.points = {{0, 0, 0}, {2, 0, 0}, {2, 0, 2}, {2, 2, 2}};
  const Fabric fabric = fabric_of(tow, yarn);
  const Result<yarn::PathRows> rows = path_rows_of(fabric, yarn, tow);
  ASSERT_TRUE(rows.ok());
  EXPECT_NEAR(rows->half_sizes[1], 0.1, 2e-3);
  EXPECT_NEAR(rows->half_sizes[2], 0.4, 8e-3);
  Diagnostics diagnostics;
  const Result<yarn::Body> body = build(fabric, diagnostics);
  ASSERT_TRUE(body.ok());
  EXPECT_TRUE(body->tight_bends.empty());
  EXPECT_NEAR(body->volume, pi / 4 * 0.16 * body->length, 2e-3 * body->volume);
}

// A sine's inner rows: the miss that is told is the largest distance from a row to the sampled curve, or a
// little more (the curve may come nearer at another parameter than the row's own).
TEST(BuildTest, LoopPathsTellHowFarTheyMissTheirPoints) {
  Yarn yarn = straight("y", 3);
  Path& path = std::get<Path>(yarn.shape);
  path.form = yarn::PathForm::loop;
  path.points.clear();
  for (int i = 0; i < 9; ++i) path.points.emplace_back(i, std::sin(0.9 * i), 0.3 * std::cos(1.3 * i));
  Diagnostics diagnostics;
  const Result<yarn::Body> body = build(fabric_of(cotton(), yarn), diagnostics);
  ASSERT_TRUE(body.ok()) << to_string(body.error());
  double largest = 0.0;
  for (const Vec3& point : path.points) {
    double nearest = 1e9;
    for (int i = 0; i <= 20000; ++i)
      nearest = std::min(nearest, (nurbs::evaluate(body->axis, i / 20000.0) - point).norm());
    largest = std::max(largest, nearest);
  }
  EXPECT_NEAR(body->path_miss, largest, 3e-6);
}

TEST(BuildTest, ASectionThatTurnsInAConstructionIsAWarningUnlessItIsRound) {
  Weave weave;
  weave.warp = {{"t"}, {}, 2, 1.0};
  weave.weft = {{"t"}, {}, 2, 1.0};
  Fabric fabric;
  fabric.items = {weave};
  const std::vector<yarn::Section> sections = {yarn::Ellipse{0.6, 0.2}, yarn::Circle{0.2}};
  for (const yarn::Section& section : sections)
    for (const bool rotates : {true, false}) {
      Thread thread;
      thread.name = "t";
      thread.section = section;
      thread.twist = Twist{300, Hand::z, rotates};
      fabric.threads = {thread};
      Diagnostics diagnostics;
      ASSERT_TRUE(YarnBuilder::create(fabric, {}, diagnostics));
      EXPECT_EQ(diagnostics.messages().size(), &section == sections.data() && rotates ? 1U : 0U);
    }
}

TEST(BuildTest, TheSevenPointSectionSaysHowRoundItIs) {
  Thread thread = cotton();
  thread.section = yarn::Loop7{};
  Diagnostics diagnostics;
  const Result<yarn::Body> body = build(fabric_of(thread, straight("y", 3)), diagnostics);
  ASSERT_TRUE(body.ok()) << to_string(body.error());
  ASSERT_EQ(diagnostics.messages().size(), 1U);
  EXPECT_EQ(diagnostics.messages().front().severity, Severity::note);
  // Radii of the surface's first ring of points: the spread that the note tells.
  double low = 1e9, high = 0, sum = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 p = nurbs::evaluate(body->surface, i / 4000.0, body->surface.first_v());
    const double radius = std::hypot(p.y(), p.z());
    low = std::min(low, radius);
    high = std::max(high, radius);
    sum += radius / 4000.0;
  }
  const std::string told = diagnostics.messages().front().text;
  EXPECT_NEAR(std::stod(told.substr(told.find("by ") + 3)), 100 * (high - low) / sum, 0.05) << told;
}

// Yarns of one shape are swept once and moved, their end faces with them: each centre stands in its outline.
TEST(BuildTest, FansMoveWithTheirYarns) {
  Weave weave;
  weave.warp = {{"cotton30"}, {}, 3, 0.7};
  weave.weft = {{"cotton30"}, {}, 2, 0.7};
  Fabric fabric = fabric_of(cotton(), straight("y", 1));
  fabric.items = {weave};
  BuildOptions options;
  options.ends = yarn::EndStyle::fan;
  Diagnostics diagnostics;
  const std::optional<YarnBuilder> builder = YarnBuilder::create(fabric, options, diagnostics);
  ASSERT_TRUE(builder);
  for (std::size_t i = 0; i < builder->count(); ++i) {
    const Result<yarn::Body> body = builder->build(i);
    ASSERT_TRUE(body);
    for (const yarn::EndFace* end : {&body->start, &body->end}) {
      const Vec3 centre = end->surface.points.back();
      EXPECT_LT((centre - end->origin).norm(), 1e-9) << body->name;
      EXPECT_LT((centre - end->surface.points.front()).norm(), 0.2) << body->name;
    }
  }
}

}  // namespace
}  // namespace selvage::fabric
