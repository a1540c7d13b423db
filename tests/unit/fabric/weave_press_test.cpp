// Dense weaves: sections that are pressed, as they stand in the built cloth, against areas, distances and
// lengths found by other means than the construction's; and the remedies for a jammed cloth, tried.
#include <fmt/format.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <regex>
#include <set>

#include "fabric/build.h"
#include "fabric/weave_press.h"
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

// By the trapezoidal rule over the angle about an ellipse (power section).
double area_by_sums(const yarn::Section& section) {
  const auto* ellipse = std::get_if<yarn::Ellipse>(&section);
  const auto* power = std::get_if<yarn::Power>(&section);
  const double width = ellipse != nullptr ? ellipse->width : power->width,
               height = ellipse != nullptr ? ellipse->height : power->height,
               exponent = ellipse != nullptr ? 1.0 : power->exponent;
  constexpr int steps = 200'000;
  double area = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double u = (i + 0.5) / steps;
    area += std::pow(1.0 - u * u, 0.5 * exponent) / steps;
  }
  return width * height * area;
}

struct Station {
  Vec3 centre, along, across, up;
};

// A yarn's sections, upright in the cloth, by its centre line alone.
std::vector<Station> stations_of(const YarnPlan& plan, bool is_weft, int count) {
  std::vector<Station> stations;
  for (int i = 0; i <= count; ++i) {
    const nurbs::CurveJet jet = nurbs::evaluate_jet(plan.line.curve, static_cast<double>(i) / count);
    Station s;
    s.centre = jet.position + plan.at;
    s.along = jet.d1.normalized();
    s.across = is_weft ? Vec3(Vec3::UnitX()) : Vec3(Vec3::UnitY());
    s.up = s.along.cross(s.across).normalized();
    if (s.up.z() < 0.0) s.up = -s.up;
    stations.push_back(s);
  }
  return stations;
}

// How deep points of the surface of `a` lie in the sections of `b`, at most; negative: outside. The sections
// are ellipses or power sections: 1 - |x|^2 - |y|^(2/n) in half axes.
double deepest(const YarnPlan& a, bool a_is_weft, const YarnPlan& b, bool b_is_weft) {
  const auto exponent = [](const YarnPlan& plan) {
    const auto* power = std::get_if<yarn::Power>(&plan.spec.section);
    return power != nullptr ? power->exponent : 1.0;
  };
  const yarn::SectionSize a_size = a.spec.sizes.front().size, b_size = b.spec.sizes.front().size;
  double most = -1e9;
  const std::vector<Station> others = stations_of(b, b_is_weft, 1500);
  for (const Station& s : stations_of(a, a_is_weft, 300))
    for (int k = 0; k < 32; ++k) {
      const double t = 2.0 * pi * k / 32, sine = std::sin(t);
      const Vec3 p = s.centre + 0.5 * a_size.width * std::cos(t) * s.across +
                     0.5 * a_size.height * std::copysign(std::pow(std::abs(sine), exponent(a)), sine) * s.up;
      // The section of b in whose plane p lies, near it.
      for (std::size_t i = 0; i + 1 < others.size(); ++i) {
        const double here = (p - others[i].centre).dot(others[i].along),
                     next = (p - others[i + 1].centre).dot(others[i + 1].along);
        if (here < 0.0 || next >= 0.0) continue;
        const Vec3 d = p - others[i].centre;
        const double x = d.dot(others[i].across) / (0.5 * b_size.width),
                     y = d.dot(others[i].up) / (0.5 * b_size.height);
        most = std::max(most, 1.0 - x * x - std::pow(std::abs(y), 2.0 / exponent(b)));
      }
    }
  return most;
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

// Pressed sections keep their area until the fibres have to come nearer to each other, and never lie denser
// than hexagons.
TEST(PressedWeave, SectionsKeepTheirAreaOrTheirFibresComeCloser) {
  const Fabric square = round(0.5, 0.84), twill = denim();
  const YarnPlan round_yarn = planned(building(square), "warp_2");
  EXPECT_NEAR(area_by_sums(round_yarn.spec.section), pi / 16.0, 1e-6);
  EXPECT_GT(round_yarn.spec.sizes.front().size.width, 0.5);
  const YarnBuilder builder = building(twill);
  for (const auto& [name, tex] : {std::pair{"warp_2", 84.36}, std::pair{"weft_2", 98.42}}) {
    const double packing = tex / (1520.0 * area_by_sums(planned(builder, name).spec.section));
    EXPECT_GT(packing, 0.6 - 1e-6) << name;
    EXPECT_LT(packing, pi / (2.0 * std::sqrt(3.0)) + 1e-6) << name;
  }
}

// No point of a yarn lies in a section of another, in the tightest of these cloths.
TEST(PressedWeave, YarnsThatCrossStayApart) {
  for (const Fabric& fabric : {denim(), round(0.5, 0.8)}) {
    const YarnBuilder builder = building(fabric);
    for (const char* warp : {"warp_3", "warp_4"})
      for (const char* weft : {"weft_4", "weft_5"}) {
        const YarnPlan a = planned(builder, warp), b = planned(builder, weft);
        EXPECT_LT(deepest(a, false, b, true), 0.0) << warp << ' ' << weft;
        EXPECT_GT(deepest(a, false, b, true), -0.5) << "they cross";
      }
    const YarnPlan yarn = planned(builder, "warp_3");
    EXPECT_LE(yarn.spec.sizes.front().size.width, std::get<Weave>(fabric.items.front()).warp.pitch);
  }
}

// Kevlar of 1500 denier, 13.8 a centimetre both ways, basket 2/2: 0.60 mm; today's sines made it 1.12 mm.
TEST(PressedWeave, WideTowsAreNotLiftedOffEachOther) {
  Thread tow = yarn_of("a", 1500.0 / 9.0, 1.44, 0.774);
  tow.section = yarn::Ellipse{0.68, 0.28};
  Fabric fabric = cloth_of(tow, 0.726, tow, 0.726, Draft::Form::basket, 2, 2);
  fabric.threads.pop_back();
  EXPECT_NEAR(thickness_of_built(building(fabric)), 0.60, 0.15 * 0.60);
}

// Glass cloth 7628: EC9 68 both ways, 44 x 34 an inch, 0.180 mm, 208 g/m2 (a mill's data sheet).
TEST(PressedWeave, AGlassClothHasTheThicknessAndMassOfItsDataSheet) {
  const Thread glass = yarn_of("a", 68.0, 2.54, 0.7);
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
TEST(PressedWeave, ThePoplinsWarpTakesTheCrimp) {
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
    ASSERT_TRUE(std::regex_search(text, found, std::regex("pressed to ([0-9.]+) mm at the least"))) << text;
    told.insert(std::stod(found[1]));
  }
  EXPECT_EQ(told.size(), 1U);
  dense(fabric).thickness = *told.begin();
  Diagnostics again;
  EXPECT_TRUE(YarnBuilder::create(fabric, {}, again).has_value());
}

// Turned by a quarter, or told in another unit, it is the same cloth.
TEST(PressedWeave, WhatIsPressedDoesNotDependOnNamesAndUnits) {
  PressedSystems systems;
  systems.warp = {yarn::Circle{0.343}, {0.343, 0.343}, 0.45, 0.45, 0.7};
  systems.weft = {yarn::Circle{0.371}, {0.371, 0.371}, 0.588, 0.588, 0.7};
  systems.clearance = 0.005;
  const Pressed one = press(systems);
  EXPECT_TRUE(one.is_sound);
  std::swap(systems.warp, systems.weft);
  const Pressed turned = press(systems);
  EXPECT_NEAR(one.warp.height, turned.weft.height, 2e-4);
  EXPECT_NEAR(one.weft.height_share, turned.warp.height_share, 1e-3);
  for (PressedSystem* system : {&systems.warp, &systems.weft}) {
    system->pitch *= 1000.0;
    system->room *= 1000.0;
    system->size = {1000.0 * system->size.width, 1000.0 * system->size.height};
    system->section = yarn::Circle{system->size.width};
  }
  systems.clearance *= 1000.0;
  const Pressed larger = press(systems);
  EXPECT_NEAR(larger.warp.height / turned.warp.height, 1000.0, 1e-9);
}

// A share of the crimp that is asked for is kept when yarns are pressed.
TEST(PressedWeave, AShareOfTheCrimpIsKept) {
  Fabric fabric = round(0.5, 0.85);
  dense(fabric).crimp = 0.5;
  const YarnBuilder builder = building(fabric);
  const double warp = std::abs(planned(builder, "warp_2").points[2].z()),
               weft = std::abs(planned(builder, "weft_2").points[2].z());
  EXPECT_NEAR(warp / (warp + weft), 0.5, 1e-3);
}

// A basket 2/2: pairs of yarns a clearance apart, pairs two pitches apart; and in a draft with gaps of one
// and of two changes each, more room for two: bending energy c / g^3 is the same at the margin, g^4 : c.
TEST(PressedWeave, RelaxedSpacingKeepsTheRepeatAndMovesYarnsTogetherUnderFloats) {
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
TEST(PressedWeave, TheLeastThicknessIsOneNumber) {
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
  ASSERT_TRUE(std::regex_search(text, found, std::regex("pressed to ([0-9.]+) mm at the least"))) << text;
  const double least = std::stod(found[1]);
  for (const double share : {0.8, 0.9, 0.95, 0.97, 0.98, 0.99})
    EXPECT_NE(refusal(share * least).find(found[0]), std::string::npos)
        << share << ": " << refusal(share * least);
  for (const double share : {1.0, 1.005, 1.01, 1.02, 1.05, 1.1, 1.3})
    EXPECT_EQ(refusal(share * least), "") << share;
}

// Each of the three remedies that a jammed cloth's error names, tried as it stands there.
TEST(PressedWeave, TheRemediesForAJammedClothWork) {
  const Fabric jammed = round(0.5, 0.6);
  Diagnostics diagnostics;
  ASSERT_FALSE(YarnBuilder::create(jammed, {}, diagnostics).has_value());
  const Message& message = *diagnostics.first_error();
  EXPECT_EQ(message.place.line, 6);
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
