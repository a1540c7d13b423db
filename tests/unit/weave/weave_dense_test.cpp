// Dense weaves: cloths against their data sheets, by sections, heights and lengths of what is built; and the
// remedies for a jammed cloth, tried.
#include <fmt/format.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <regex>
#include <set>

#include "construction/build.h"
#include "nurbs/measure.h"

namespace selvage::fabric {
namespace {

using std::numbers::pi;

Thread yarn_of(std::string name, double tex, double density, double packing) {
  Thread thread;
  thread.name = std::move(name);
  thread.place = {2, 1};
  thread.linear_density = LinearDensity{tex};
  thread.density = density;
  thread.packing = packing;
  return thread;
}

// A cloth of `count` both ways; warp at line 5, weft at line 6.
Fabric cloth_of(const Thread& warp, double warp_pitch, const Thread& weft, double weft_pitch,
                Draft::Form form = Draft::Form::plain, int a = 0, int b = 0, int count = 8) {
  Fabric fabric;
  fabric.file = "test.txt";
  fabric.threads = {warp, weft};
  Weave weave;
  weave.place = {4, 1};
  weave.warp = {{warp.name}, {5, 3}, count, warp_pitch};
  weave.weft = {{weft.name}, {6, 3}, count, weft_pitch};
  weave.draft.form = form;
  weave.draft.a = a;
  weave.draft.b = b;
  fabric.items = {weave};
  return fabric;
}

Weave& dense(Fabric& fabric) {
  return std::get<Weave>(fabric.items.front());
}

// 12 oz: 26 x 17 a centimetre of Ne 7 and 6.
Fabric denim() {
  return cloth_of(yarn_of("a", 84.36, 1.52, 0.6), 0.3846, yarn_of("b", 98.42, 1.52, 0.6), 0.588,
                  Draft::Form::twill, 3, 1);
}

Fabric round(double diameter, double pitch) {
  Thread thread;
  thread.name = "a";
  thread.diameter = diameter;
  Fabric fabric = cloth_of(thread, pitch, thread, pitch);
  fabric.threads.pop_back();
  return fabric;
}

YarnBuilder building(const Fabric& fabric) {
  Diagnostics diagnostics;
  std::optional<YarnBuilder> builder = YarnBuilder::create(fabric, {}, diagnostics);
  if (!builder) throw std::runtime_error(to_string(*diagnostics.first_error()));
  return std::move(*builder);
}

YarnPlan planned(const YarnBuilder& builder, const char* name) {
  Result<YarnPlan> plan = builder.plan(builder.find(name).value());
  if (!plan) throw std::runtime_error(to_string(plan.error()));
  return std::move(*plan);
}

double crimp_of(const YarnPlan& plan, double extent) {
  return nurbs::arc_length(plan.line.curve) / extent - 1.0;
}

// Of the built surfaces.
double thickness_of_built(const YarnBuilder& builder) {
  double low = 1e9, high = -1e9;
  for (const char* name : {"warp_1", "warp_2", "weft_1", "weft_2"}) {
    const yarn::Body body = builder.build(builder.find(name).value()).value();
    std::vector<double> even;
    for (int i = 0; i <= 400; ++i) even.push_back(i / 400.0);
    for (const Vec3& p : nurbs::evaluate_grid(body.surface, even, even)) {
      low = std::min(low, p.z());
      high = std::max(high, p.z());
    }
  }
  return high - low;
}

// Fibres come closer than they lie at rest, and never lie denser than hexagons, at any place.
TEST(DenseWeave, FibresComeCloser) {
  const Fabric twill = denim();
  const YarnBuilder builder = building(twill);
  for (const auto& [name, tex] : {std::pair{"warp_2", 84.36}, std::pair{"weft_2", 98.42}}) {
    double most = 0.0;
    const YarnPlan plan = planned(builder, name);
    for (const yarn::SizeAtParameter& at : plan.spec.sizes) {
      const double packing = tex / (1520.0 * 0.25 * pi * at.size.width * at.size.height);
      EXPECT_GT(packing, 0.6) << name;
      EXPECT_LT(packing, pi / (2.0 * std::sqrt(3.0)) + 1e-6) << name;
      most = std::max(most, packing);
    }
    EXPECT_GT(most, 0.74) << name;
  }
}

// Kevlar of 1500 denier, 13.8 a centimetre both ways, basket 2/2: 0.60 mm by its data sheet.
TEST(DenseWeave, ABasketOfTowsCanBeAsThinAsItsDataSheet) {
  Thread tow = yarn_of("a", 1500.0 / 9.0, 1.44, 0.774);
  tow.filaments = 1000;
  Fabric fabric = cloth_of(tow, 0.726, tow, 0.726, Draft::Form::basket, 2, 2);
  fabric.threads.pop_back();
  dense(fabric).thickness = 0.60;
  EXPECT_NEAR(thickness_of_built(building(fabric)), 0.60, 0.01 * 0.60);
}

// Glass cloth 7628: EC9 68 both ways, 44 x 34 an inch, 0.180 mm, 208 g/m2 (a mill's data sheet).
TEST(DenseWeave, AGlassClothHasTheThicknessAndMassOfItsDataSheet) {
  Thread glass = yarn_of("a", 68.0, 2.54, 0.7);
  glass.filaments = 400;
  const double warp_pitch = 25.4 / 44.0, weft_pitch = 25.4 / 34.0;
  Fabric fabric = cloth_of(glass, warp_pitch, glass, weft_pitch);
  fabric.threads.pop_back();
  dense(fabric).thickness = 0.180;
  const YarnBuilder builder = building(fabric);
  EXPECT_NEAR(thickness_of_built(builder), 0.180, 0.01 * 0.180);
  const double warp = crimp_of(planned(builder, "warp_3"), 8.0 * weft_pitch),
               weft = crimp_of(planned(builder, "weft_3"), 8.0 * warp_pitch);
  EXPECT_NEAR(68.0 * ((1.0 + warp) / warp_pitch + (1.0 + weft) / weft_pitch), 208.0, 0.05 * 208.0);
}

// Poplin bends its warp and hardly its weft (133 x 72 an inch of Ne 40).
TEST(DenseWeave, ThePoplinsWarpTakesTheCrimp) {
  const Thread cotton = yarn_of("a", 590.5412 / 40.0, 1.52, 0.6);
  Fabric fabric = cloth_of(cotton, 25.4 / 133.0, cotton, 25.4 / 72.0);
  fabric.threads.pop_back();
  dense(fabric).thickness = 0.25;
  const YarnBuilder builder = building(fabric);
  const double warp = crimp_of(planned(builder, "warp_3"), 8.0 * 25.4 / 72.0),
               weft = crimp_of(planned(builder, "weft_3"), 8.0 * 25.4 / 133.0);
  EXPECT_GT(warp, 1.5 * weft);
  EXPECT_LT(warp, 0.15);
  // The least thickness is one number, whatever was asked for, and is built.
  std::set<double> told;
  for (const double too_thin : {0.05, 0.08, 0.1}) {
    dense(fabric).thickness = too_thin;
    Diagnostics diagnostics;
    EXPECT_FALSE(YarnBuilder::create(fabric, {}, diagnostics).has_value());
    const std::string text = diagnostics.first_error()->text;
    std::smatch found;
    ASSERT_TRUE(std::regex_search(text, found, std::regex("in equilibrium it is ([0-9.]+) mm at the least")))
        << text;
    told.insert(std::stod(found[1]));
  }
  EXPECT_EQ(told.size(), 1U);
  dense(fabric).thickness = *told.begin();
  Diagnostics again;
  EXPECT_TRUE(YarnBuilder::create(fabric, {}, again).has_value());
}

// A share of the crimp that is asked for is kept where yarns flatten.
TEST(DenseWeave, AShareOfTheCrimpIsKept) {
  Fabric fabric = round(0.5, 0.85);
  dense(fabric).crimp = 0.5;
  const YarnBuilder builder = building(fabric);
  const double warp = std::abs(planned(builder, "warp_2").points[2].z()),
               weft = std::abs(planned(builder, "weft_2").points[2].z());
  EXPECT_NEAR(warp / (warp + weft), 0.5, 1e-3);
}

// A basket 2/2: pairs of yarns a clearance apart, pairs two pitches apart; and in a draft with gaps of one
// and of two changes each, more room for two: bending energy c / g^3 is the same at the margin, g^4 : c.
TEST(DenseWeave, RelaxedSpacingKeepsTheRepeatAndMovesYarnsTogetherUnderFloats) {
  Fabric fabric = round(0.3, 0.5);
  dense(fabric).draft.form = Draft::Form::basket;
  dense(fabric).draft.a = dense(fabric).draft.b = 2;
  const auto places = [](const Fabric& of) {
    const YarnBuilder builder = building(of);
    std::vector<double> at;
    for (const char* name : {"warp_1", "warp_2", "warp_3", "warp_4", "warp_5"})
      at.push_back(planned(builder, name).points.front().y());
    return at;
  };
  const std::vector<double> even = places(fabric);
  for (std::size_t i = 0; i < even.size(); ++i) EXPECT_EQ(even[i], (static_cast<double>(i) + 0.5) * 0.5);
  dense(fabric).spacing = Weave::Spacing::relaxed;
  const std::vector<double> at = places(fabric);
  EXPECT_NEAR(at[1] - at[0], 0.3 * 1.01 + 2.0 * 0.3e-3, 1e-9);  // and twice the tolerance
  EXPECT_NEAR(at[2] - at[0], 1.0, 1e-12);
  EXPECT_NEAR(at[4] - at[0], 2.0, 1e-12);

  // Wefts of four: 1100 / 1100 / 0011 / 1011: of four warps four, one, three and none change between them.
  dense(fabric).draft.form = Draft::Form::rows;
  dense(fabric).draft.rows = {"1100", "1100", "0011", "1011"};
  const YarnBuilder builder = building(fabric);
  std::vector<double> wefts;
  for (const char* name : {"weft_1", "weft_2", "weft_3", "weft_4", "weft_5"})
    wefts.push_back(planned(builder, name).points.front().x());
  EXPECT_NEAR(wefts[4] - wefts[0], 2.0, 1e-12);
  EXPECT_LT(wefts[1] - wefts[0], 0.31);
  EXPECT_NEAR(std::pow((wefts[2] - wefts[1]) / (wefts[4] - wefts[3]), 4.0), 4.0 / 3.0, 1e-6);
  EXPECT_NEAR(wefts[3] - wefts[2], 0.5, 1e-9);  // one change: at the pitch, no less
}

// Carbon tows of 200 tex, 2 mm apart: whatever thickness is refused, the error names one; no thickness from
// there on is refused, and none below is accepted.
TEST(DenseWeave, TheLeastThicknessIsOneNumber) {
  const Thread tow = yarn_of("a", 200.0, 1.76, 0.78);
  const auto refusal = [&](double thickness) {
    Fabric fabric = cloth_of(tow, 2.0, tow, 2.0, Draft::Form::plain, 0, 0, 2);
    fabric.threads.pop_back();
    dense(fabric).thickness = thickness;
    Diagnostics diagnostics;
    return YarnBuilder::create(fabric, {}, diagnostics) ? std::string() : diagnostics.first_error()->text;
  };
  const std::string text = refusal(0.1);
  std::smatch found;
  ASSERT_TRUE(std::regex_search(text, found, std::regex("in equilibrium it is ([0-9.]+) mm at the least")))
      << text;
  const double least = std::stod(found[1]);
  for (const double share : {0.8, 0.9, 0.95, 0.97, 0.98, 0.99})
    EXPECT_NE(refusal(share * least).find(found[0]), std::string::npos)
        << share << ": " << refusal(share * least);
  for (const double share : {1.0, 1.005, 1.01, 1.02, 1.05, 1.1, 1.3})
    EXPECT_EQ(refusal(share * least), "") << share;
}

// Each of the three remedies that a jammed cloth's error names, tried as it stands there.
TEST(DenseWeave, TheRemediesForAJammedClothWork) {
  const Fabric jammed = round(0.5, 0.6);
  Diagnostics diagnostics;
  ASSERT_FALSE(YarnBuilder::create(jammed, {}, diagnostics).has_value());
  const Message& message = *diagnostics.first_error();
  EXPECT_EQ(message.place.line, 4);
  std::smatch found;
  const std::regex pattern(
      "it is ([0-9.]+) % too dense.*`pitch ([0-9.]+)` for the warp and `pitch ([0-9.]+)` for the weft; or "
      "`diameter ([0-9.]+)` for thread 'a'; or `pitch ([0-9.]+)` for the weft alone");
  ASSERT_TRUE(std::regex_search(message.text, found, pattern)) << message.text;
  const auto number = [&](std::size_t i) { return std::stod(found[i]); };
  EXPECT_NEAR(number(2) / 0.6, 1.0 + 0.01 * number(1), 0.02);
  Fabric wider = jammed, thinner = jammed, fewer_picks = jammed;
  dense(wider).warp.pitch = number(2);
  dense(wider).weft.pitch = number(3);
  thinner.threads.front().diameter = number(4);
  dense(fewer_picks).weft.pitch = number(5);
  for (const Fabric& remedied : {wider, thinner, fewer_picks}) {
    Diagnostics told;
    EXPECT_TRUE(YarnBuilder::create(remedied, {}, told).has_value()) << to_string(*told.first_error());
  }
}

}  // namespace
}  // namespace selvage::fabric
