// Kinds of yarns and twist factors against the list of fibres, conversions of the trade and the angle of a
// helix.
#include "weave/yarn_kind.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include "fabric/fibres.h"

namespace selvage::fabric {
namespace {

Thread thread_of(std::string material, std::optional<int> filaments = std::nullopt) {
  Thread thread;
  if (!material.empty()) thread.material = std::move(material);
  thread.filaments = filaments;
  return thread;
}

std::string kind(const Thread& thread) {
  return std::string(yarn_kind_of(thread, true).name);
}

double factor(const Thread& thread, Unit units = Unit::mm, bool is_warp = true) {
  const Result<std::optional<double>> found = twist_factor_of(thread, units, is_warp);
  if (!found) {
    ADD_FAILURE() << found.error().text;
    return -1;
  }
  EXPECT_TRUE(found->has_value());
  return found->value_or(-1);
}

Thread cotton(double tex, double turns) {
  Thread thread = thread_of("cotton");
  thread.density = 1.52;
  thread.packing = 0.6;
  thread.linear_density = LinearDensity{tex, LinearDensity::Measure::tex};
  thread.twist = Twist{turns};
  return thread;
}

// The packing fraction of the list, 0.6, 0.75 or 1, was chosen for staple fibres, filaments and wires.
TEST(YarnKind, OfEveryFibreOfTheList) {
  const std::set<std::string> staple{"spun yarn", "worsted yarn"}, continuous{"filament yarn", "tow"},
      solid{"monofilament"};
  for (const Fibre& fibre : all_fibres()) {
    const std::string found = kind(thread_of(fibre.material.name));
    SCOPED_TRACE(fibre.material.name + ": " + found);
    const double packing = fibre.material.packing.value();
    const std::set<std::string>& expected = packing == 1.0 ? solid : packing < 0.7 ? staple : continuous;
    EXPECT_TRUE(expected.contains(found));
  }
}

TEST(YarnKind, ByMaterialUnderItsOtherNames) {
  EXPECT_EQ(kind(thread_of("Merino")), "worsted yarn");
  EXPECT_EQ(kind(thread_of("kevlar")), "tow");
  EXPECT_EQ(kind(thread_of("E-glass")), "tow");
  EXPECT_EQ(kind(thread_of("T700")), "tow");
  EXPECT_EQ(kind(thread_of("basalt")), "tow");
  EXPECT_EQ(kind(thread_of("PES")), "filament yarn");
  EXPECT_EQ(kind(thread_of("CO")), "spun yarn");
}

TEST(YarnKind, ByFilaments) {
  EXPECT_EQ(kind(thread_of("")), "spun yarn");
  EXPECT_EQ(kind(thread_of("", 48)), "filament yarn");
  EXPECT_EQ(kind(thread_of("viscose")), "spun yarn");
  EXPECT_EQ(kind(thread_of("viscose", 48)), "filament yarn");
  EXPECT_EQ(kind(thread_of("cotton", 80)), "spun yarn");
  EXPECT_EQ(kind(thread_of("carbon", 3000)), "tow");
  EXPECT_EQ(kind(thread_of("steel", 12)), "filament yarn");
  for (const char* material : {"", "nylon", "steel", "my own fibre"}) {
    const YarnKind found = yarn_kind_of(thread_of(material, 1), false);
    EXPECT_EQ(found.name, "monofilament");
    EXPECT_TRUE(found.is_solid);
  }
  Thread cable = thread_of("nylon", 1);
  cable.plies = Plies{3, 200};
  EXPECT_FALSE(yarn_kind_of(cable, false).is_solid);
  EXPECT_EQ(kind(cable), "filament yarn");
}

TEST(YarnKind, SolidWhereAllOfTheSectionIsFibre) {
  Thread wire = thread_of("my own alloy");
  EXPECT_FALSE(yarn_kind_of(wire, true).is_solid);
  wire.material_packing = 1.0;
  EXPECT_TRUE(yarn_kind_of(wire, true).is_solid);
  wire.diameter = 0.1;
  wire.twist = Twist{1e5};
  const Result<std::optional<double>> found = twist_factor_of(wire, Unit::mm, true);
  ASSERT_TRUE(found.ok());
  EXPECT_FALSE(found->has_value());
}

// Twist multipliers of the cotton trade: turns per inch over the root of the cotton count.
TEST(TwistFactor, UsualOnes) {
  const double multiplier = std::sqrt(590.5412) / 0.0254;  // of 1, in turns/m sqrt(tex)
  EXPECT_NEAR(factor(thread_of("cotton")) / multiplier, 4.2, 0.1);
  EXPECT_NEAR(factor(thread_of("cotton"), Unit::mm, false) / multiplier, 3.5, 0.1);
  for (const bool is_warp : {true, false}) {
    // Metric twist factors: turns per metre over the root of Nm, 1000 / tex.
    EXPECT_NEAR(factor(thread_of("wool"), Unit::mm, is_warp) / std::sqrt(1000.0), 89, 1);
    EXPECT_EQ(factor(thread_of("glass"), Unit::mm, is_warp), 0);
    const double filament = factor(thread_of("nylon"), Unit::mm, is_warp);
    EXPECT_GT(filament, 0);
    EXPECT_LT(filament, 300);
  }
}

// Ne 20 with 18.8 turns per inch has the twist multiplier 18.8 / sqrt(20).
TEST(TwistFactor, OfTheThreadsOwnTwist) {
  Thread thread = cotton(0, 18.8 / 0.0254);
  thread.linear_density = LinearDensity{20, LinearDensity::Measure::ne};
  EXPECT_NEAR(factor(thread), 18.8 / std::sqrt(20.0) * std::sqrt(590.5412) / 0.0254, 0.01);
  EXPECT_EQ(factor(thread), factor(thread, Unit::mm, false));
  const double z = factor(thread);
  thread.twist->hand = Hand::s;
  EXPECT_EQ(factor(thread), z);
  thread.twist->turns = 0;
  EXPECT_EQ(factor(thread), 0);
}

TEST(TwistFactor, OfPlyYarnsIsThatOfThePly) {
  // R 40 tex/2, singles of 20 tex.
  Thread thread = cotton(40, 900);
  thread.plies = Plies{2, 600};
  EXPECT_NEAR(factor(thread), 600 * std::sqrt(40.0), 1e-9);
  thread.twist.reset();
  EXPECT_NEAR(factor(thread), 600 * std::sqrt(40.0), 1e-9);
  thread.twist = Twist{900};
  thread.plies->turns = 0;
  EXPECT_NEAR(factor(thread), 900 * std::sqrt(20.0), 1e-9);
}

TEST(TwistFactor, LinearDensityFromTheSection) {
  Thread thread;
  thread.twist = Twist{800};
  thread.diameter = 0.2;
  // Of pi/4 0.2^2 mm2, 60 % of it fibre of 1.5 g/cm3: g/km are mm2 g/cm3 times 1000.
  const double tex = std::numbers::pi / 4 * 0.04 * 0.6 * 1.5 * 1000;
  EXPECT_NEAR(factor(thread), 800 * std::sqrt(tex), 1e-9);
  thread.diameter = 0.02;
  EXPECT_NEAR(factor(thread, Unit::cm), 800 * std::sqrt(tex), 1e-9);
  thread.diameter = 0.2;
  thread.density = 1.2;
  thread.material_packing = 0.75;
  EXPECT_NEAR(factor(thread), 800 * std::sqrt(tex * 1.25 * 0.8), 1e-9);
  thread.diameter.reset();
  thread.section = yarn::Ellipse{0.4, 0.1};
  EXPECT_NEAR(factor(thread), 800 * std::sqrt(tex * 1.25 * 0.8), 1e-9);
}

// A helix with the radius of its pitch over 2 pi rises at 45 degrees.
TEST(TwistFactor, SurfaceAngleOfAtMost45Degrees) {
  Thread thread;
  thread.place = {7, 1};
  thread.diameter = 0.5;
  const double limit = 1000 / (std::numbers::pi * 0.5);  // turns per metre
  thread.twist = Twist{limit};
  EXPECT_GT(factor(thread), 0);
  for (const double times : {1.0001, 2.0}) {
    thread.twist = Twist{times * limit};
    const Result<std::optional<double>> found = twist_factor_of(thread, Unit::mm, true);
    ASSERT_FALSE(found.ok());
    EXPECT_EQ(found.error().kind, Kind::geometry);
    EXPECT_EQ(found.error().place.line, 7);
    EXPECT_NE(found.error().text.find("0.5 mm"), std::string::npos);
    EXPECT_NE(found.error().text.find("at most 636 turns/m"), std::string::npos) << found.error().text;
    const char* const angle = times == 2.0 ? "63.4 degrees" : "45.1 degrees";
    EXPECT_NE(found.error().text.find(angle), std::string::npos) << found.error().text;
  }
  thread.twist = Twist{636};
  EXPECT_GT(factor(thread), 0);
}

TEST(TwistFactor, TwistWithoutASize) {
  Thread thread;
  thread.place = {3, 1};
  thread.twist = Twist{800};
  const Result<std::optional<double>> found = twist_factor_of(thread, Unit::mm, true);
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().place.line, 3);
  // A linear density alone is enough: a fibre of 1.5 g/cm3 and a packing fraction of 0.6 are assumed.
  thread.linear_density = LinearDensity{25, LinearDensity::Measure::tex};
  EXPECT_NEAR(factor(thread), 4000, 1e-9);
}

}  // namespace
}  // namespace selvage::fabric
