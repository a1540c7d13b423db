// Cloth in equilibrium against what is known of it: derivatives by differences, units, quarter turns,
// Peirce's geometry of rigid wires, plates.
#include "mechanics/woven.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace selvage::mechanics {
namespace {

using Eigen::VectorXd;

// Ends over which each pick is under the warp: rows of 0 and 1.
WovenCloth cloth_of(const std::vector<std::vector<int>>& draft, double area = 0.0132, double pitch = 0.38) {
  WovenCloth cloth;
  WovenYarn yarn;
  yarn.fibre_area = area;
  cloth.wefts.assign(draft.size(), yarn);
  cloth.warps.assign(draft.front().size(), yarn);
  cloth.weft_gaps.assign(draft.size(), 1.1 * pitch);
  cloth.warp_gaps.assign(draft.front().size(), pitch);
  for (const std::vector<int>& pick : draft)
    for (const int end : pick) cloth.warp_on_top.push_back(static_cast<char>(end));
  cloth.clearance = 0.002;
  return cloth;
}

const std::vector<std::vector<int>> plain = {{1, 0}, {0, 1}};
const std::vector<std::vector<int>> twill = {{1, 1, 0}, {0, 1, 1}, {1, 0, 1}};

WovenEquilibrium found(const WovenCloth& cloth) {
  Result<WovenEquilibrium> result = find_equilibrium(cloth);
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().text);
  return std::move(*result);
}

// All sizes and control values of a cloth, warps first; lengths divided by `unit`.
std::vector<double> numbers_of(const WovenEquilibrium& equilibrium, const WovenCloth& cloth, double unit) {
  std::vector<double> made;
  for (const WovenSystem system : {WovenSystem::warp, WovenSystem::weft}) {
    const int yarns = system == WovenSystem::warp ? cloth.ends() : cloth.picks(),
              crossings = system == WovenSystem::warp ? cloth.picks() : cloth.ends();
    for (int yarn = 0; yarn < yarns; ++yarn)
      for (int knot = 0; knot < spans_a_gap * crossings; ++knot) {
        made.push_back(equilibrium.control_height(system, yarn, knot) / unit);
        const auto size = equilibrium.size(system, yarn, knot / static_cast<double>(spans_a_gap));
        made.push_back(size.width / unit);
        made.push_back(size.height / unit);
      }
  }
  return made;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double most = 0.0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

// Columns of warps above each other, each warp by the wefts of a place below it at every place.
WovenCloth stacked(const std::vector<std::vector<std::vector<int>>>& columns, int layers, double area = 1.0,
                   double pitch = 3.2) {
  WovenCloth cloth;
  WovenYarn yarn;
  yarn.fibre_area = area;
  cloth.wefts_a_row = layers;
  cloth.first_warps = {0};
  const std::size_t rows = columns.front().front().size();
  for (const auto& column : columns)
    cloth.first_warps.push_back(cloth.first_warps.back() + static_cast<int>(column.size()));
  for (std::size_t row = 0; row < rows; ++row)
    for (int layer = 0; layer < layers; ++layer)
      for (const auto& column : columns)
        for (const std::vector<int>& levels : column)
          cloth.warp_on_top.push_back(levels[row] > layer ? 1 : 0);
  cloth.warps.assign(static_cast<std::size_t>(cloth.first_warps.back()), yarn);
  cloth.wefts.assign(rows * static_cast<std::size_t>(layers), yarn);
  cloth.warp_gaps.assign(columns.size(), pitch);
  cloth.weft_gaps.assign(rows, 1.1 * pitch);
  cloth.clearance = 0.01;
  return cloth;
}

void make_wires(WovenCloth& cloth) {
  for (auto* yarns : {&cloth.warps, &cloth.wefts})
    for (WovenYarn& yarn : *yarns) {
      yarn.packing = yarn.max_packing = 1.0;
      yarn.stiffness = 1000;
    }
}

double axis_height(const WovenEquilibrium& cloth, WovenSystem system, int yarn, int knot) {
  return (cloth.control_height(system, yarn, knot - 1) + 4.0 * cloth.control_height(system, yarn, knot) +
          cloth.control_height(system, yarn, knot + 1)) /
         6.0;
}

void expect_derivatives_agree(const WovenCloth& cloth, double most_noise) {
  WovenProblem problem(cloth, classes_of(cloth, 256));
  Minimum at;
  at.x = problem.start(0.6);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> noise(-most_noise, most_noise);
  for (double& value : at.x) value += noise(random);
  problem.update(at, 1e-9);
  VectorXd inequalities;
  problem.evaluate(at.x, inequalities);
  ASSERT_GT(inequalities.size(), 100);
  std::uniform_real_distribution<double> weight(0.0, 1.0);
  VectorXd multipliers(inequalities.size());
  for (double& value : multipliers) value = weight(random);
  const VectorXd none = VectorXd::Zero(inequalities.size());
  // Of the Lagrangian: gradient by differences of values, second derivatives by differences of gradients.
  const auto gradient_at = [&](const VectorXd& x) -> VectorXd {
    Derivatives made{{}, {}, problem.places()};
    problem.differentiate(x, multipliers, none, made);
    return made.gradient - made.gradients.combined(multipliers, problem.num_unknowns());
  };
  Derivatives made{{}, {}, problem.places()};
  problem.differentiate(at.x, multipliers, none, made);
  const VectorXd gradient = gradient_at(at.x);
  const Eigen::SparseMatrix<double> second = made.second;
  constexpr double step = 1e-5;
  for (Eigen::Index k = 0; k < problem.num_unknowns(); k += 5) {
    VectorXd up = at.x, down = at.x, values;
    up[k] += step;
    down[k] -= step;
    const double high = problem.evaluate(up, values) - multipliers.dot(values);
    const double low = problem.evaluate(down, values) - multipliers.dot(values);
    EXPECT_NEAR(gradient[k], (high - low) / (2 * step), 1e-6 * (1.0 + std::abs(gradient[k]))) << k;
    const VectorXd column = (gradient_at(up) - gradient_at(down)) / (2 * step);
    for (Eigen::Index row = k; row < problem.num_unknowns(); ++row)
      EXPECT_NEAR(second.coeff(row, k), column[row], 1e-5 * (1.0 + std::abs(column[row]))) << row << ' ' << k;
  }
}

TEST(Woven, DerivativesAgreeWithDifferences) {
  WovenCloth cloth = cloth_of(twill, 1.0, 3.2);
  cloth.wefts[1].fibre_area = 0.8;
  cloth.clearance = 0.01;
  cloth.thickness = 3.0;
  expect_derivatives_agree(cloth, 0.03);
  expect_derivatives_agree(stacked({{{1, 0}, {2, 1}}, {{0, 2}}}, 2), 0.03);
}

TEST(Woven, AClothOfLayersTurnedUpsideDownHasTheOppositeHeights) {
  WovenCloth cloth = stacked({{{1, 0, 1}, {2, 1, 1}}, {{0, 1, 2}}, {{0, 2, 1}}}, 2);
  // Levels are the layers less those of before; warps of a column and wefts of a row change their order.
  WovenCloth turned = stacked({{{0, 1, 1}, {1, 2, 1}}, {{2, 1, 0}}, {{2, 0, 1}}}, 2);
  cloth.warps[1].fibre_area = turned.warps[0].fibre_area = 0.7;
  const WovenEquilibrium a = found(cloth), b = found(turned);
  const std::vector<int> warps = {1, 0, 2, 3}, wefts = {1, 0, 3, 2, 5, 4};
  for (int knot = 0; knot < 3 * spans_a_gap; ++knot) {
    for (int k = 0; k < cloth.ends(); ++k)
      EXPECT_NEAR(a.control_height(WovenSystem::warp, k, knot),
                  -b.control_height(WovenSystem::warp, warps[static_cast<std::size_t>(k)], knot), 1e-6)
          << k << ' ' << knot;
    for (int k = 0; k < cloth.picks(); ++k)
      EXPECT_NEAR(a.control_height(WovenSystem::weft, k, knot),
                  -b.control_height(WovenSystem::weft, wefts[static_cast<std::size_t>(k)], knot), 1e-6)
          << k << ' ' << knot;
  }
}

TEST(Woven, WiresAboveEachOtherTouch) {
  constexpr double clearance = 0.01;
  const double diameter = 2.0 / std::sqrt(std::numbers::pi);
  // Straight ones: every warp between both layers of wefts.
  WovenCloth straight = stacked({{{1}}}, 2, 1.0, 4.0);
  make_wires(straight);
  straight.thickness = 3.0 * diameter + 2.0 * clearance + 1e-3;
  const WovenEquilibrium flat = found(straight);
  EXPECT_NEAR(axis_height(flat, WovenSystem::weft, 1, 0) - axis_height(flat, WovenSystem::weft, 0, 0),
              2.0 * (diameter + clearance), 5e-3);
  // Two as one in plain weave: one diameter apart where they cross a weft, h1 + h2 = d1 + d2 from it.
  WovenCloth pairs = stacked({{{1, 0}, {1, 0}}, {{0, 1}, {0, 1}}}, 1, 1.0, 6.0);
  make_wires(pairs);
  const WovenEquilibrium pair = found(pairs);
  const double lower = axis_height(pair, WovenSystem::warp, 0, 0),
               upper = axis_height(pair, WovenSystem::warp, 1, 0),
               weft = axis_height(pair, WovenSystem::weft, 0, 0);
  EXPECT_NEAR(lower - weft, diameter + clearance, 5e-3);
  EXPECT_NEAR(upper - lower, diameter + clearance, 5e-3);
}

TEST(Woven, OneWarpAColumnAndOneWeftARowAreTheClothWithoutLevels) {
  const WovenCloth one = stacked({{{1, 0, 1}}, {{1, 1, 0}}, {{0, 1, 1}}}, 1, 0.0132, 0.38);
  WovenCloth same = cloth_of(twill);
  same.clearance = one.clearance;
  EXPECT_EQ(numbers_of(found(one), one, 1.0), numbers_of(found(same), same, 1.0));
}

TEST(Woven, SaysWhereARepeatHasTooManyClasses) {
  const auto refused = find_equilibrium(cloth_of(twill), {.max_classes = 2});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, Kind::limit);
}

TEST(Woven, IsTheSameInEveryUnit) {
  const WovenCloth cloth = cloth_of(twill);
  const std::vector<double> here = numbers_of(found(cloth), cloth, 1.0);
  for (const double unit : {1e-3, 1.0 / 25.4, 1e3}) {
    WovenCloth other = cloth;
    for (auto* yarns : {&other.warps, &other.wefts})
      for (WovenYarn& yarn : *yarns) yarn.fibre_area *= unit * unit;
    for (auto* gaps : {&other.warp_gaps, &other.weft_gaps})
      for (double& gap : *gaps) gap *= unit;
    other.clearance *= unit;
    EXPECT_LT(largest_difference(numbers_of(found(other), other, unit), here), 1e-8) << unit;
  }
}

TEST(Woven, IsTheSameWithOtherLastDigits) {
  const WovenCloth cloth = cloth_of(twill);
  WovenCloth other = cloth;
  for (double& gap : other.warp_gaps) gap *= 1.0 + 1e-9;
  for (WovenYarn& yarn : other.wefts) yarn.fibre_area *= 1.0 - 1e-9;
  EXPECT_LT(largest_difference(numbers_of(found(cloth), cloth, 1.0), numbers_of(found(other), other, 1.0)),
            1e-8);
}

TEST(Woven, AQuarterTurnExchangesTheSystems) {
  WovenCloth cloth = cloth_of(twill);
  cloth.weft_tension = 1.7;
  for (WovenYarn& yarn : cloth.wefts) yarn.fibre_area *= 1.2;
  // The warp becomes the weft; which is on top is exchanged by the turn over (x y z -> y x -z).
  WovenCloth turned = cloth;
  std::swap(turned.warps, turned.wefts);
  std::swap(turned.warp_gaps, turned.weft_gaps);
  std::swap(turned.warp_tension, turned.weft_tension);
  for (int pick = 0; pick < turned.picks(); ++pick)
    for (int end = 0; end < turned.ends(); ++end)
      turned.warp_on_top[static_cast<std::size_t>(pick * turned.ends() + end)] =
          cloth.warp_on_top[static_cast<std::size_t>(end * cloth.ends() + pick)];
  const WovenEquilibrium a = found(cloth), b = found(turned);
  for (int yarn = 0; yarn < cloth.ends(); ++yarn)
    for (int knot = 0; knot < spans_a_gap * cloth.picks(); ++knot)
      EXPECT_NEAR(a.control_height(WovenSystem::warp, yarn, knot),
                  -b.control_height(WovenSystem::weft, yarn, knot), 1e-8);
  EXPECT_NEAR(a.energy().sum(), b.energy().sum(), 1e-9);
}

TEST(Woven, RigidWiresOfAPlainClothTouchAtTheirCrossings) {
  // F. T. Peirce 1937: h1 + h2 = d1 + d2.
  WovenCloth cloth = cloth_of(plain, 1.0, 4.0);
  make_wires(cloth);
  cloth.clearance = 0.0;
  const WovenEquilibrium wires = found(cloth);
  const auto height = [&](WovenSystem system) {  // of the axis at the first crossing
    return (wires.control_height(system, 0, -1) + 4.0 * wires.control_height(system, 0, 0) +
            wires.control_height(system, 0, 1)) /
           6.0;
  };
  const double diameter = 2.0 / std::sqrt(std::numbers::pi);
  EXPECT_NEAR(height(WovenSystem::warp) - height(WovenSystem::weft), diameter, 2e-3 * diameter);
  const auto size = wires.size(WovenSystem::warp, 0, 0.0);
  EXPECT_NEAR(size.width, diameter, 5e-3 * diameter);
  EXPECT_NEAR(size.height, diameter, 5e-3 * diameter);
}

TEST(Woven, YarnsOfALooseClothAreNearlyRoundAndOfADenseOneFlat) {
  const auto ratio = [](double pitch) {
    const WovenEquilibrium cloth = found(cloth_of(plain, 0.0132, pitch));
    const auto size = cloth.size(WovenSystem::warp, 0, 0.0);
    return size.height / size.width;
  };
  const double loose = ratio(1.2), dense = ratio(0.30);
  EXPECT_GT(loose, 0.85);
  EXPECT_LT(dense, 0.75);
}

TEST(Woven, TensionMovesTheWavesToTheOtherSystem) {
  const auto share = [](double weft_tension) {
    WovenCloth cloth = cloth_of(plain);
    cloth.weft_tension = weft_tension;
    const WovenEquilibrium result = found(cloth);
    const auto rise = [&](WovenSystem system) { return std::abs(result.control_height(system, 0, 0)); };
    return rise(WovenSystem::warp) / (rise(WovenSystem::warp) + rise(WovenSystem::weft));
  };
  EXPECT_GT(share(2.0), share(1.0));
  EXPECT_LT(share(0.5), share(1.0));
}

TEST(Woven, PlatesPressTheClothToItsThickness) {
  WovenCloth cloth = cloth_of(plain);
  const auto top_of = [](const WovenEquilibrium& equilibrium, WovenSystem system) {
    const double height =
        (equilibrium.control_height(system, 0, -1) + 4.0 * equilibrium.control_height(system, 0, 0) +
         equilibrium.control_height(system, 0, 1)) /
        6.0;
    return std::abs(height) + 0.5 * equilibrium.size(system, 0, 0.0).height;
  };
  const WovenEquilibrium free = found(cloth);
  const double half = std::max(top_of(free, WovenSystem::warp), top_of(free, WovenSystem::weft));
  cloth.thickness = 2.0 * 0.9 * half;
  const WovenEquilibrium pressed = found(cloth);
  EXPECT_LE(top_of(pressed, WovenSystem::warp), 0.9 * half * (1.0 + 1e-6));
  EXPECT_LE(top_of(pressed, WovenSystem::weft), 0.9 * half * (1.0 + 1e-6));
  EXPECT_GT(pressed.energy().sum(), free.energy().sum());
}

TEST(Woven, TheWarpHasTheShareOfTheWavesThatIsAskedFor) {
  WovenCloth cloth = cloth_of(twill);
  cloth.warp_share = 0.7;
  const WovenEquilibrium result = found(cloth);
  double warp = 0.0, weft = 0.0;
  for (int pick = 0; pick < 3; ++pick)
    for (int end = 0; end < 3; ++end) {
      const double side = cloth.warp_on_top[static_cast<std::size_t>(3 * pick + end)] != 0 ? 1.0 : -1.0;
      const auto height = [&](WovenSystem system, int yarn, int crossing) {
        const int knot = spans_a_gap * crossing;
        return (result.control_height(system, yarn, knot - 1) +
                4.0 * result.control_height(system, yarn, knot) +
                result.control_height(system, yarn, knot + 1)) /
               6.0;
      };
      warp += side * height(WovenSystem::warp, end, pick);
      weft -= side * height(WovenSystem::weft, pick, end);
    }
  EXPECT_NEAR(warp / (warp + weft), 0.7, 1e-6);
}

// Flat tows, 0.2 of a pitch thick by themselves.
WovenCloth tows(const std::vector<std::vector<int>>& draft) {
  WovenCloth cloth = cloth_of(draft, 0.1125, 2.0);
  cloth.weft_gaps = cloth.warp_gaps;
  for (auto* yarns : {&cloth.warps, &cloth.wefts})
    for (WovenYarn& yarn : *yarns) yarn.stiffness = stiffness_by_twist(0);
  return cloth;
}

// The work of plates is that of the energy: it grows the faster, the nearer they are.
TEST(Woven, PlatesPressACloth) {
  for (const auto& draft : {plain, {{1, 1, 0, 0}, {0, 1, 1, 0}, {0, 0, 1, 1}, {1, 0, 0, 1}}}) {
    const WovenCloth cloth = tows(draft);
    const WovenEquilibrium free = found(cloth);
    EXPECT_EQ(free.pressed(1.01 * free.thickness()).energy().sum(), free.energy().sum());
    std::vector<double> energies = {free.energy().sum()};
    for (const double part : {0.95, 0.9, 0.85, 0.8}) {
      const double thickness = part * free.thickness();
      const WovenEquilibrium pressed = free.pressed(thickness);
      EXPECT_NEAR(pressed.thickness(), thickness, 1e-7 * thickness);
      EXPECT_LT(pressed.overlap(), 1e-6);
      energies.push_back(pressed.energy().sum());
      WovenCloth between = cloth;
      between.thickness = thickness;
      EXPECT_LT(largest_difference(numbers_of(pressed, cloth, 2.0), numbers_of(found(between), cloth, 2.0)),
                1e-6);
      EXPECT_NEAR(free.pressed(0.97 * free.thickness()).pressed(thickness).energy().sum() / energies.back(),
                  1.0, 1e-3);
    }
    for (std::size_t k = 2; k < energies.size(); ++k)
      EXPECT_GT(energies[k] - energies[k - 1], energies[k - 1] - energies[k - 2]);
  }
}

// Force is the derivative of energy by distance.
TEST(Woven, ThePressureOfPlatesIsThatOfTheirWork) {
  const WovenEquilibrium free = found(tows(plain));
  EXPECT_NEAR(free.pressure() / WovenConstants().pressure, 1.0, 1e-6);
  for (const double part : {0.95, 0.85, 0.8}) {
    constexpr double change = 1e-4;
    const WovenEquilibrium at = free.pressed(part * free.thickness()),
                           nearer = at.pressed((1.0 - change) * at.thickness());
    // Energies are of one crossing, over tension * sqrt(area); a crossing has 2 x 2.
    const double force =
        (nearer.energy().sum() - at.energy().sum()) / (change * at.thickness() / std::sqrt(0.1125));
    EXPECT_NEAR(at.pressure() / (force / (4.0 / 0.1125)), 1.0, 5e-3) << part;
    WovenCloth cloth = tows(plain);
    cloth.pressure = at.pressure();
    const WovenEquilibrium pressed = found(cloth);
    EXPECT_NEAR(pressed.thickness() / at.thickness(), 1.0, 1e-6) << part;
    EXPECT_NEAR(pressed.pressure() / at.pressure(), 1.0, 1e-6) << part;
  }
  WovenCloth both = tows(plain);
  both.pressure = free.pressed(0.9 * free.thickness()).pressure();
  both.thickness = 0.85 * free.thickness();
  EXPECT_NEAR(found(both).thickness() / *both.thickness, 1.0, 1e-7);
  WovenCloth cloth = tows(plain);
  cloth.pressure = 100.0;
  EXPECT_NEAR(found(cloth).thickness() / free.pressed(0.01).thickness(), 1.0, 0.01);
}

// Hexagonal packing fills every yarn: 2 * 0.1125 / 2 of fibre over 0.907 is the least height of what lies
// there.
TEST(Woven, PlatesComeNoNearerThanFibresArePacked) {
  const WovenEquilibrium free = found(tows(plain)), pressed = free.pressed(0.01);
  const double solid = 0.1125 / densest_packing;
  EXPECT_GT(pressed.thickness(), solid);
  EXPECT_LT(pressed.thickness(), 4.0 / std::numbers::pi * 1.1 * solid);  // of ellipses, nearly side by side
  for (const double crossings : {0.0, 0.5}) {
    const auto size = pressed.size(WovenSystem::warp, 0, crossings);
    EXPECT_LT(0.1125 / (std::numbers::pi / 4.0 * size.width * size.height), densest_packing * (1.0 + 1e-6));
  }
  EXPECT_NEAR(free.pressed(1.003 * pressed.thickness()).thickness(), 1.003 * pressed.thickness(), 1e-8);
}

TEST(Woven, ACloseClothIsJammed) {
  // Fibres need 0.0132 / 0.907 = 0.0146; a warp between its neighbours is 0.3 high and
  // rises by more than that over 0.055: no slope allows it.
  const Result<WovenEquilibrium> result = find_equilibrium(cloth_of(plain, 0.0132, 0.05));
  ASSERT_FALSE(result.ok());
  EXPECT_NE(result.error().text.find("residual"), std::string::npos) << result.error().text;
}

}  // namespace
}  // namespace selvage::mechanics
