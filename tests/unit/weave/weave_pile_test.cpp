// Woven pile against lengths and heights computed otherwise: a loop of two legs and a half turn, tufts as
// long as the floats that they are cut from, cloths upside down and in other units.
#include <fmt/format.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <regex>

#include "construction/build.h"
#include "nurbs/measure.h"

namespace selvage::fabric {
namespace {

using std::numbers::pi;

Thread cotton(std::string name, double tex) {
  Thread thread;
  thread.name = std::move(name);
  thread.place = {2, 1};
  thread.linear_density = LinearDensity{tex};
  thread.density = 1.52;
  thread.packing = 0.6;
  return thread;
}

// 12 ends and picks of 50 tex, 13 x 18 per cm; the pile of 37 tex.
Fabric cloth(double unit = 1.0) {
  Fabric fabric;
  fabric.file = "test.txt";
  fabric.tolerance = 2e-4 / unit;
  fabric.threads = {cotton("ground", 50), cotton("pile", 37)};
  Weave weave;
  weave.place = {4, 1};
  weave.warp = {{"ground"}, {5, 3}, 12, 10.0 / 13.0 / unit};
  weave.weft = {{"ground"}, {6, 3}, 12, 10.0 / 18.0 / unit};
  fabric.items = {weave};
  return fabric;
}
Weave& weave_of(Fabric& fabric) {
  return std::get<Weave>(fabric.items.front());
}
Fabric with_pile(double height, WarpPile::Side side = WarpPile::Side::face, bool is_cut = false,
                 int picks = 3) {
  Fabric fabric = cloth();
  weave_of(fabric).pile = WarpPile{{8, 3}, height, "pile", picks, side, is_cut};
  return fabric;
}
Fabric with_weft_pile(Draft::Form form, int ends) {
  Fabric fabric = cloth();
  weave_of(fabric).draft = {};
  weave_of(fabric).draft.form = form;
  weave_of(fabric).draft.a = ends;
  weave_of(fabric).warp.pitch = 10.0 / 16.0;
  weave_of(fabric).weft.threads = {"ground", "pile", "pile"};
  weave_of(fabric).weft.pitch = 10.0 / 32.0;
  return fabric;
}

using Plans = std::map<std::string, YarnPlan>;

Plans plans_of(const Fabric& fabric) {
  Diagnostics diagnostics;
  const std::optional<YarnBuilder> builder = YarnBuilder::create(fabric, {}, diagnostics);
  if (!builder) throw std::runtime_error(to_string(*diagnostics.first_error()));
  Plans plans;
  for (std::size_t i = 0; i < builder->count(); ++i) {
    Result<YarnPlan> plan = builder->plan(i);
    if (!plan) throw std::runtime_error(to_string(plan.error()));
    plans.emplace(plan->name, std::move(*plan));
  }
  return plans;
}

bool is_pile(const std::string& name) {
  return name.starts_with("pile_");
}
double length_of(const YarnPlan& plan) {
  return nurbs::arc_length(plan.line.curve);
}

// Height of the section at a parameter, between the sizes along the yarn.
double thickness_at(const YarnPlan& plan, double t) {
  const auto& sizes = plan.spec.sizes;
  for (std::size_t k = 1; k < sizes.size(); ++k)
    if (t <= sizes[k].parameter)
      return std::lerp(sizes[k - 1].size.height, sizes[k].size.height,
                       (t - sizes[k - 1].parameter) / (sizes[k].parameter - sizes[k - 1].parameter));
  return sizes.back().size.height;
}

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
};
// Of points along the yarns, with half the section that is there where `has_section`.
template <class Counts>
Range heights(const Plans& plans, bool has_section, const Counts& counts) {
  Range range;
  for (const auto& [name, plan] : plans) {
    if (!counts(name)) continue;
    for (int k = 0; k <= 2000; ++k) {
      const double z = nurbs::evaluate(plan.line.curve, k / 2000.0).z() + plan.at.z();
      const double half = has_section ? 0.5 * thickness_at(plan, k / 2000.0) : 0.0;
      range.low = std::min(range.low, z - half);
      range.high = std::max(range.high, z + half);
    }
  }
  return range;
}
Range ground_of(const Plans& plans) {
  return heights(plans, true, [](const std::string& name) { return !is_pile(name); });
}

TEST(WovenPile, HasTheHeightOfItsTextOverTheGround) {
  constexpr double near = 3e-4;  // of the ground's highest place by samples
  for (const double height : {1.0, 2.5, 8.0}) {
    const Plans loops = plans_of(with_pile(height, WarpPile::Side::both));
    const Range ground = ground_of(loops), pile = heights(loops, true, is_pile);
    EXPECT_NEAR(pile.high - ground.high, height, near);
    EXPECT_NEAR(ground.low - pile.low, height, near);
    // Ends of tufts are cut there.
    const Plans tufts = plans_of(with_pile(height, WarpPile::Side::back, true));
    EXPECT_NEAR(ground_of(tufts).low - heights(tufts, false, is_pile).low, height, near);
  }
}

// Between z and the apex a loop is a straight leg, half a turn and a straight leg.
TEST(WovenPile, ALoopIsTwoLegsAndAHalfTurn) {
  std::map<double, double> lengths;
  constexpr int loops = 3;  // of 12 picks, the first one of them bound; the edge cuts the fourth
  for (const double height : {2.0, 3.0, 6.0}) {
    const YarnPlan pile = plans_of(with_pile(height)).at("pile_1");
    lengths[height] = length_of(pile);
    // At the middle of the height: by how much both legs are apart, over all loops.
    std::vector<Vec3> points;
    for (int k = 0; k <= 20000; ++k) points.push_back(nurbs::evaluate(pile.line.curve, k / 20000.0));
    std::vector<double> places;
    double above = 0.0;
    for (std::size_t k = 1; k < points.size(); ++k) {
      const double middle = 0.5 * height;
      if ((points[k - 1].z() > middle) != (points[k].z() > middle)) places.push_back(points[k].x());
      if (points[k].z() > middle) above += (points[k] - points[k - 1]).norm();
    }
    ASSERT_EQ(places.size() % 2, 0U);
    const std::size_t count = places.size() / 2;
    EXPECT_GE(count, static_cast<std::size_t>(loops));
    double top = -1.0, apart = 0.0;
    for (const Vec3& point : points) top = std::max(top, point.z());
    for (std::size_t k = 0; k < count; ++k) apart += places[2 * k + 1] - places[2 * k];
    // A convex arc is longer than its chords, shorter than the box about it, here within 3 % of a semicircle
    // on legs.
    const double width = apart / static_cast<double>(count), rise = top - 0.5 * height;
    const double expected = 2.0 * (rise - 0.5 * width) + 0.5 * pi * width;
    EXPECT_NEAR(above / static_cast<double>(count) / expected, 1.0, 0.03) << height;
  }
  // A higher loop differs by its legs.
  const double loops_built = std::round((lengths[6.0] - lengths[3.0]) / 6.0);
  EXPECT_GE(loops_built, loops);
  EXPECT_NEAR((lengths[3.0] - lengths[2.0]) / (2.0 * loops_built), 1.0, 0.01);
  EXPECT_NEAR((lengths[6.0] - lengths[3.0]) / (6.0 * loops_built), 1.0, 0.01);
}

// The same draft as rows is the cloth before it is cut.
TEST(WovenPile, TuftsAreAsLongAsTheirFloats) {
  for (const Draft::Form form : {Draft::Form::corduroy, Draft::Form::velveteen}) {
    Fabric fabric = with_weft_pile(form, 6);
    const Plans cut = plans_of(fabric);
    Weave& weave = weave_of(fabric);
    weave.draft = {};
    weave.draft.form = Draft::Form::rows;
    int ground = 0, pile = 0;
    for (int pick = 0; pick < 18; ++pick) {
      std::string row(6, '0');
      if (pick % 3 == 0) {
        for (std::size_t end = ground++ % 2; end < 6; end += 2) row[end] = '1';
      } else {
        const int k = pile++;
        row[static_cast<std::size_t>(form == Draft::Form::corduroy ? 3 - k % 2 : 2 * (k % 3))] = '1';
      }
      weave.draft.rows.push_back(row);
    }
    weave.warp.count = 18;
    const Plans whole = plans_of(fabric);
    for (const int pick : {2, 3, 5, 6}) {
      // One float and its bound part: from the middle of a float to the next one, six ends on.
      const YarnPlan& weft = whole.at(fmt::format("weft_{}", pick));
      const nurbs::Curve& curve = weft.line.curve;
      const auto at = [&](double y) {
        double low = 0.0, high = 1.0;
        for (int k = 0; k < 60; ++k) {
          const double middle = 0.5 * (low + high);
          (nurbs::evaluate(curve, middle).y() < y ? low : high) = middle;
        }
        return low;
      };
      const double expected =
          nurbs::arc_length(curve, at(6.2 * weave.warp.pitch), at(12.2 * weave.warp.pitch));
      EXPECT_NEAR(length_of(cut.at(fmt::format("pile_{}_tuft_1", pick))) / expected, 1.0, 2e-4) << pick;
    }
  }
}

// The plain ground upside down is the plain ground a pick on.
TEST(WovenPile, OnTheBackIsThatOfTheFaceUpsideDown) {
  for (const bool is_cut : {false, true}) {
    Fabric face = with_pile(2.0, WarpPile::Side::face, is_cut),
           back = with_pile(2.0, WarpPile::Side::back, is_cut);
    weave_of(face).draft.form = weave_of(back).draft.form = Draft::Form::rows;
    weave_of(face).draft.rows = {"10", "01"};
    weave_of(back).draft.rows = {"01", "10"};
    const Plans up = plans_of(face), down = plans_of(back);
    ASSERT_EQ(up.size(), down.size());
    for (const auto& [name, plan] : up) {
      const YarnPlan& other = down.at(name);
      for (int k = 0; k <= 50; ++k) {
        const Vec3 here = nurbs::evaluate(plan.line.curve, k / 50.0) + plan.at;
        Vec3 there = nurbs::evaluate(other.line.curve, k / 50.0) + other.at;
        there.z() = -there.z();
        EXPECT_LT((here - there).norm(), 1e-7) << name << ' ' << k;
      }
    }
  }
}

TEST(WovenPile, IsTheSameInEveryUnit) {
  const auto in = [](Unit unit, bool is_cut) {
    Fabric fabric = cloth(millimetres_per(unit));
    fabric.units = unit;
    weave_of(fabric).pile =
        WarpPile{{8, 3}, 2.0 / millimetres_per(unit), "pile", 4, WarpPile::Side::both, is_cut};
    return plans_of(fabric);
  };
  for (const bool is_cut : {false, true}) {
    const Plans expected = in(Unit::mm, is_cut);
    for (const Unit unit : {Unit::um, Unit::cm, Unit::m, Unit::inch}) {
      const Plans found = in(unit, is_cut);
      ASSERT_EQ(found.size(), expected.size());
      for (const auto& [name, plan] : expected)
        for (int k = 0; k <= 20; ++k) {
          const YarnPlan& other = found.at(name);
          const Vec3 here = nurbs::evaluate(plan.line.curve, k / 20.0) + plan.at,
                     there = nurbs::evaluate(other.line.curve, k / 20.0) + other.at;
          EXPECT_LT((here - millimetres_per(unit) * there).norm(), 1e-7) << name << ' ' << k;
        }
    }
  }
}

TEST(WovenPile, NamesItsYarns) {
  Fabric loops = with_pile(2.0);
  weave_of(loops).warp.count = 2;
  weave_of(loops).weft.count = 6;
  const auto names = [](const Plans& plans) {
    std::vector<std::string> all;
    for (const auto& [name, plan] : plans) all.push_back(name);
    return all;
  };
  EXPECT_EQ(names(plans_of(loops)),
            (std::vector<std::string>{"pile_1", "pile_2", "warp_1", "warp_2", "weft_1", "weft_2", "weft_3",
                                      "weft_4", "weft_5", "weft_6"}));
  weave_of(loops).warp.count = 1;
  weave_of(loops).pile->is_cut = true;
  EXPECT_EQ(names(plans_of(loops)),
            (std::vector<std::string>{"pile_1_tuft_1", "pile_1_tuft_2", "warp_1", "weft_1", "weft_2",
                                      "weft_3", "weft_4", "weft_5", "weft_6"}));
}

Message refusal_of(const Fabric& fabric) {
  Diagnostics diagnostics;
  EXPECT_FALSE(YarnBuilder::create(fabric, {}, diagnostics).has_value());
  return diagnostics.first_error() != nullptr ? *diagnostics.first_error() : Message{};
}
double number_in(const std::string& text, const char* pattern) {
  std::smatch found;
  return std::regex_search(text, found, std::regex(pattern)) ? std::stod(found[1]) : 0.0;
}

TEST(WovenPile, RefusedOnesAreBuiltWithTheirRemedies) {
  Fabric low = with_pile(0.05);
  const Message refused = refusal_of(low);
  EXPECT_EQ(refused.place.line, 8);
  weave_of(low).pile->height = number_in(refused.text, "([0-9.]+) mm at least");
  ASSERT_GT(weave_of(low).pile->height, 0.05) << refused.text;
  EXPECT_GT(plans_of(low).size(), 0U);
  weave_of(low).pile->height *= 0.97;
  refusal_of(low);

  // Warp pile asks for picks, weft pile for ends that are further apart.
  Fabric thick = with_pile(3.0);
  thick.threads.back() = cotton("pile", 200);
  weave_of(thick).weft.pitch = 0.45;
  const Message no_room = refusal_of(thick);
  EXPECT_EQ(no_room.place.line, 8);
  weave_of(thick).weft.pitch = number_in(no_room.text, "`pitch ([0-9.]+)` of the weft");
  EXPECT_GT(plans_of(thick).size(), 0U) << no_room.text;
}

TEST(WovenPile, ItsThreadIsThatOfTheWarpWhereItNamesNone) {
  Fabric own = with_pile(2.0), same = with_pile(2.0);
  own.threads.back() = cotton("pile", 50);
  weave_of(same).pile->thread.clear();
  const Plans a = plans_of(own), b = plans_of(same);
  EXPECT_EQ(b.at("pile_1").thread_name, "ground");
  EXPECT_NEAR(length_of(a.at("pile_1")), length_of(b.at("pile_1")), 1e-9);
  weave_of(same).pile->thread = "none";
  EXPECT_EQ(refusal_of(same).place.line, 8);
}

}  // namespace
}  // namespace selvage::fabric
