// Yarns by their points, stacks of outlines and helices: the parts by themselves.
#include "fabric/measured.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fabric/helix.h"
#include "nurbs/measure.h"
#include "yarn/grid.h"
#include "yarn/size_profile.h"
#include "yarn/tube.h"

namespace selvage::fabric {
namespace {

using std::numbers::pi;

MeasuredYarn line_of(const std::vector<Vec3>& points) {
  MeasuredYarn measured;
  measured.name = "a";
  measured.points = points;
  for (std::size_t i = 0; i < points.size(); ++i) measured.places.push_back({static_cast<int>(i) + 2, 3});
  return measured;
}

TEST(Measured, LinesPassThroughTheirPointsOrNearThem) {
  const MeasuredYarn measured = line_of({Vec3(0, 0, 0), Vec3(1, 0.01, 0), Vec3(2, -0.01, 0), Vec3(3, 0, 0)});
  const Result<Yarn> exact = yarn_of(measured, std::nullopt, true);
  ASSERT_TRUE(exact.ok());
  EXPECT_EQ(std::get<Path>(exact->shape).form, yarn::PathForm::chord);
  EXPECT_EQ(std::get<Path>(exact->shape).points, measured.points);
  const Result<Yarn> smooth = yarn_of(measured, 0.05, true);
  ASSERT_TRUE(smooth.ok());
  EXPECT_EQ(std::get<Path>(smooth->shape).form, yarn::PathForm::smooth);
  EXPECT_EQ(std::get<Path>(smooth->shape).error, 0.05);
}

TEST(Measured, PointsOutOfOrderAreToldAtTheirPlace) {
  const Result<Yarn> swapped =
      yarn_of(line_of({Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(1, 0, 0), Vec3(3, 0, 0)}), std::nullopt, true);
  ASSERT_FALSE(swapped.ok());
  EXPECT_EQ(swapped.error().place.line, 3);
  // Noise doubles back, too: less than the error it is none.
  const MeasuredYarn noisy =
      line_of({Vec3(0, 0, 0), Vec3(0.5, 0, 0), Vec3(0.49, 0.002, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)});
  EXPECT_FALSE(yarn_of(noisy, std::nullopt, true).ok());
  EXPECT_TRUE(yarn_of(noisy, 0.02, true).ok());
}

TEST(Measured, ConstantSizesAreTheSection) {
  MeasuredYarn measured = line_of({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0.5, 0)});
  measured.sizes.assign(3, SizeAt{0.4, 0.2, std::nullopt});
  const Result<Yarn> flat = yarn_of(measured, std::nullopt, true);
  ASSERT_TRUE(flat.ok());
  EXPECT_EQ(flat->own.section, std::optional<yarn::Section>(yarn::Ellipse{0.4, 0.2}));
  EXPECT_TRUE(std::get<Path>(flat->shape).sizes.empty());
  // A yarn that has a section of its own is scaled to them.
  const Result<Yarn> scaled = yarn_of(measured, std::nullopt, false);
  ASSERT_TRUE(scaled.ok());
  EXPECT_FALSE(scaled->own.section.has_value());
  EXPECT_EQ(std::get<Path>(scaled->shape).sizes[1]->width, 0.4);
}

TEST(Measured, SizesThatVaryAreKeptWithinTheError) {
  std::vector<yarn::SizeAtParameter> sizes;
  for (int i = 0; i <= 300; ++i) {
    const double t = i / 300.0;
    sizes.push_back({t, {1.0 + 0.3 * std::sin(9.0 * t), 0.5 - 0.1 * t}, 0.4 * t * t});
  }
  for (const double error : {0.1, 0.01, 0.001}) {
    const std::vector<yarn::SizeAtParameter> few = yarn::sparse_sizes(sizes, error, false);
    EXPECT_LT(few.size(), sizes.size() / 2);
    std::vector<double> at;
    std::vector<yarn::SizeProfile::Values> rows;
    for (const yarn::SizeAtParameter& size : few) {
      at.push_back(size.parameter);
      rows.push_back({size.size.width, size.size.height, size.angle});
    }
    const yarn::SizeProfile profile(at, rows, false);
    for (const yarn::SizeAtParameter& size : sizes) {
      const yarn::SizeProfile::Values value = profile.at(size.parameter).value;
      EXPECT_LE(std::abs(value[0] - size.size.width), error * (1.0 + 1e-12));
      EXPECT_LE(std::abs(value[1] - size.size.height), error * (1.0 + 1e-12));
    }
  }
}

// Circles of a cylinder, each begun elsewhere: the surface is not twisted, and goes through the points.
TEST(Measured, AStackOfOutlinesIsAGrid) {
  MeasuredYarn measured = line_of({});
  const int round = 24;
  for (int k = 0; k < 6; ++k) {
    measured.sections.push_back(measured.points.size());
    for (int i = 0; i < round; ++i) {
      const double angle = 2.0 * pi * ((k % 2 == 1 ? round - i : i) + 5.0 * k) / round;
      measured.points.emplace_back(std::cos(angle), std::sin(angle), k);
      measured.places.push_back({static_cast<int>(measured.places.size()) + 2, 1});
    }
  }
  const Result<Yarn> yarn = yarn_of(measured, std::nullopt, true);
  ASSERT_TRUE(yarn.ok());
  const Grid& grid = std::get<Grid>(yarn->shape);
  EXPECT_EQ(grid.per_section, round);
  // Columns are straight: along z.
  for (int j = 1; j < grid.sections; ++j)
    for (int i = 0; i < round; ++i) {
      const auto at = [&](int section) { return grid.points[static_cast<std::size_t>(section * round + i)]; };
      EXPECT_LT((at(j) - at(0)).head<2>().norm(), 1e-12);
    }
  yarn::Body body;
  ASSERT_TRUE(yarn::fill_from_grid(body, grid).ok());
  for (int i = 0; i < round; ++i) {
    const double u = (i + 0.5) / round;
    for (const double v : {0.0, 0.31, 1.0}) {
      const Vec3 p = nurbs::evaluate(
          body.surface, u, body.surface.first_v() + v * (body.surface.last_v() - body.surface.first_v()));
      EXPECT_LT(p.head<2>().norm(), 1.0 + 1e-9);
      EXPECT_GT(p.head<2>().norm(), std::cos(pi / round) - 1e-3);
    }
  }
}

TEST(Helix, HasItsLengthAndStaysNear) {
  Yarn yarn;
  yarn.shape = Helix{{}, 2.0, 1.5, 5.25, true, 30.0};
  for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
    const Yarn drawn = drawn_helix(yarn, tolerance);
    const Path& path = std::get<Path>(drawn.shape);
    EXPECT_EQ(path.points.size(), helix_rows(std::get<Helix>(yarn.shape), tolerance));
    const Result<yarn::CentreLine> line = yarn::make_centre_line(
        {path.form, path.points, false, drawn.tangent_start, drawn.tangent_end, {}, {}, 0.0});
    ASSERT_TRUE(line.ok());
    const double wanted = 5.25 * std::hypot(2.0 * pi * 2.0, 1.5);
    EXPECT_NEAR(nurbs::arc_length(line->curve), wanted, 10.0 * tolerance);
    for (int i = 0; i <= 5000; ++i) {
      const double t = i / 5000.0, angle = pi / 6.0 - 2.0 * pi * 5.25 * t;
      const Vec3 exact(2.0 * std::cos(angle), 2.0 * std::sin(angle), 1.5 * 5.25 * t);
      EXPECT_LT((nurbs::evaluate(line->curve, t) - exact).norm(), 0.1 * tolerance) << t;
    }
  }
}

}  // namespace
}  // namespace selvage::fabric
