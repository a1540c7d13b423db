#include "structured/raster.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "unit/fem/bodies.h"

namespace selvage::fem {
namespace {

fabric::Fabric cell_of(const Vec3& low, const Vec3& high) {
  fabric::Fabric fabric;
  fabric::Cell cell;
  cell.low = low;
  cell.high = high;
  cell.matrix = "resin";
  fabric.cell = cell;
  return fabric;
}

Raster raster_of(const fabric::Fabric& fabric, const std::vector<yarn::Body>& bodies, int count,
                 std::size_t warnings = 0) {
  Diagnostics diagnostics;
  Result<Raster> raster = rasterize(fabric, bodies, {.count = count, .threads = 2}, diagnostics);
  EXPECT_TRUE(raster.ok()) << (raster.ok() ? "" : raster.error().text);
  EXPECT_EQ(diagnostics.messages().size(), warnings);
  return raster.ok() ? *raster : Raster{};
}

yarn::Body with_fibres(yarn::Body body) {
  body.fibre_area = 0.1;
  return body;
}

// A round yarn of `radius`, its control points `turn`ed after they were set along x.
yarn::Body turned_tube(double radius, double length, const Eigen::Matrix3d& turn, const Vec3& middle,
                       const std::string& name = "tube") {
  return with_fibres(test::grid_body(name, 200, 6, [&](double angle, double share) {
    return Vec3(middle +
                turn * Vec3(length * (share - 0.5), radius * std::cos(angle), radius * std::sin(angle)));
  }));
}

std::size_t voxel(const Raster& raster, std::size_t i, std::size_t j, std::size_t k) {
  return (k * raster.count[1] + j) * raster.count[0] + i;
}

Vec3 middle_of(const Raster& raster, std::size_t i, std::size_t j, std::size_t k) {
  const Vec3 sides = raster.lengths();
  return raster.origin +
         Vec3((static_cast<double>(i) + 0.5) / static_cast<double>(raster.count[0]) * sides.x(),
              (static_cast<double>(j) + 0.5) / static_cast<double>(raster.count[1]) * sides.y(),
              (static_cast<double>(k) + 0.5) / static_cast<double>(raster.count[2]) * sides.z());
}

template <class Look>
void for_each_voxel(const Raster& raster, const Look& look) {
  for (std::size_t k = 0; k < raster.count[2]; ++k)
    for (std::size_t j = 0; j < raster.count[1]; ++j)
      for (std::size_t i = 0; i < raster.count[0]; ++i) look(i, j, k, voxel(raster, i, j, k));
}

Vec3 orientation(const Raster& raster, std::size_t at) {
  const auto& [x, y, z] = raster.orientation[at];
  return {x, y, z};
}

// Of a rectangle the area inside an ellipse round the origin, by thin strips.
double area_in_ellipse(double a, double b, double y0, double y1, double z0, double z1) {
  constexpr int strips = 4000;
  double sum = 0;
  for (int s = 0; s < strips; ++s) {
    const double y = y0 + (y1 - y0) * (s + 0.5) / strips;
    if (std::abs(y) >= a) continue;
    const double half = b * std::sqrt(1 - y * y / (a * a));
    sum += std::max(0.0, std::min(z1, half) - std::max(z0, -half)) * (y1 - y0) / strips;
  }
  return sum;
}

TEST(Raster, SharesOfEachVoxelAreThoseOfAnEllipse) {
  const yarn::Body body = with_fibres(test::straight_tube(0.8, 0.5, 4, 400, Vec3(-1, 0.71, 0.52)));
  const Raster raster = raster_of(cell_of(Vec3(0, 0, 0), Vec3(2, 1.5, 1)), {body}, 20);
  ASSERT_EQ(raster.count, (std::array<std::size_t, 3>{20, 15, 10}));
  for_each_voxel(raster, [&](std::size_t i, std::size_t j, std::size_t k, std::size_t at) {
    const double y = 0.1 * static_cast<double>(j) - 0.71, z = 0.1 * static_cast<double>(k) - 0.52;
    const double expected = area_in_ellipse(0.4, 0.25, y, y + 0.1, z, z + 0.1) / 0.01;
    EXPECT_NEAR(static_cast<double>(raster.yarn_fraction[at]), expected, 2e-3) << i << " " << j << " " << k;
    const double fibres = 0.1 / (std::numbers::pi * 0.4 * 0.25);
    EXPECT_NEAR(static_cast<double>(raster.fibre_fraction[at]), expected * fibres, 1e-3);
    EXPECT_EQ(raster.phase[at], raster.yarn_fraction[at] >= 0.5F ? 1 : 0);
    if (raster.yarn_fraction[at] > 0) {
      EXPECT_LT((orientation(raster, at) - Vec3::UnitX()).norm(), 1e-6);
    }
  });
  EXPECT_NEAR(raster.yarn, std::numbers::pi * 0.4 * 0.25 / 1.5, 3e-4 * raster.yarn);
  EXPECT_EQ(raster.phases[1].name, "tube");
  EXPECT_EQ(raster.phases[0].material, "resin");
  EXPECT_NEAR(raster.phases[0].fraction + raster.phases[1].fraction, 1, 1e-12);
}

TEST(Raster, AYarnThatRunsAnyWayKeepsItsVolumeAndDirection) {
  for (const Vec3& axis : {Vec3(1, 1, 0), Vec3(0.2, 0.1, 1), Vec3(-1, 2, 3)}) {
    const Eigen::Matrix3d turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitX(), axis).toRotationMatrix();
    const yarn::Body body = turned_tube(0.3, 1.5, turn, Vec3(1.1, 0.9, 1.05));
    const Raster raster = raster_of(cell_of(Vec3(0, 0, 0), Vec3(2, 2, 2)), {body}, 24);
    EXPECT_NEAR(raster.yarn * 8, std::numbers::pi * 0.09 * 1.5, 4e-4 * raster.yarn * 8) << axis.transpose();
    for_each_voxel(raster, [&](std::size_t, std::size_t, std::size_t, std::size_t at) {
      if (raster.yarn_fraction[at] > 0) {
        EXPECT_LT((orientation(raster, at) - axis.normalized()).norm(), 1e-5) << axis.transpose();
      }
    });
  }
}

TEST(Raster, WhatTheCellCutsOffIsNotCounted) {
  // Through both ends of the cell along z, wider than a voxel: some columns see nothing of its surface.
  const Eigen::Matrix3d up =
      Eigen::Quaterniond::FromTwoVectors(Vec3::UnitX(), Vec3::UnitZ()).toRotationMatrix();
  const yarn::Body body = turned_tube(0.4, 5, up, Vec3(1, 1, 0.5));
  const Raster raster = raster_of(cell_of(Vec3(0, 0, 0), Vec3(2, 2, 1)), {body}, 30);
  EXPECT_NEAR(raster.yarn * 4, std::numbers::pi * 0.16, 3e-4);
  for_each_voxel(raster, [&](std::size_t i, std::size_t j, std::size_t k, std::size_t at) {
    if (raster.yarn_fraction[at] > 0) {
      EXPECT_LT((orientation(raster, at) - Vec3::UnitZ()).norm(), 1e-5);
    }
    EXPECT_NEAR(raster.yarn_fraction[at], raster.yarn_fraction[voxel(raster, i, j, 0)], 1e-6) << k;
  });
}

TEST(Raster, ARingRunsRound) {
  const double large = 0.7, small = 0.2;
  const yarn::Body body = with_fibres(test::grid_body(
      "ring", 400, 400,
      [&](double angle, double share) {
        const double round = 2 * std::numbers::pi * share, out = large + small * std::cos(angle);
        return Vec3(1 + out * std::cos(round), 1 + out * std::sin(round), 0.3 + small * std::sin(angle));
      },
      true));
  const Raster raster = raster_of(cell_of(Vec3(0, 0, 0), Vec3(2, 2, 0.6)), {body}, 40);
  const double exact = 2 * std::numbers::pi * std::numbers::pi * large * small * small;
  EXPECT_NEAR(raster.yarn * 2.4, exact, 1e-3 * exact);
  for_each_voxel(raster, [&](std::size_t i, std::size_t j, std::size_t k, std::size_t at) {
    if (raster.yarn_fraction[at] == 0) return;
    const Vec3 out = middle_of(raster, i, j, k) - Vec3(1, 1, 0.3);
    const Vec3 round = Vec3(-out.y(), out.x(), 0).normalized();
    EXPECT_LT((orientation(raster, at) - round).norm(), 1e-3) << out.transpose();
  });
}

TEST(Raster, OverlapsAreCountedOnceAndTold) {
  const Eigen::Matrix3d across =
      Eigen::Quaterniond::FromTwoVectors(Vec3::UnitX(), Vec3::UnitY()).toRotationMatrix();
  std::vector<yarn::Body> bodies = {turned_tube(0.3, 4, Eigen::Matrix3d::Identity(), Vec3(1, 1, 0.5), "a"),
                                    turned_tube(0.3, 4, across, Vec3(1, 1, 0.5), "b")};
  const Raster raster = raster_of(cell_of(Vec3(0, 0, 0), Vec3(2, 2, 1)), bodies, 60, 1);
  // What two round yarns that cross at a right angle share: Steinmetz's solid, 16 r^3 / 3.
  const double shared = 16 * 0.027 / 3;
  EXPECT_NEAR(raster.overlap * 4, shared, 0.03 * shared);
  EXPECT_NEAR(raster.yarn * 4, 2 * std::numbers::pi * 0.09 * 2 - shared, 0.03 * shared);
  for (const float one : raster.yarn_fraction) EXPECT_LE(one, 1.0F);
}

TEST(Raster, UnknownFibresAreToldAndNotANumber) {
  const Raster raster = raster_of(cell_of(Vec3(0, 0, 0), Vec3(2, 1.5, 1)),
                                  {test::straight_tube(0.8, 0.5, 4, 24, Vec3(-1, 0.75, 0.5))}, 12, 1);
  EXPECT_TRUE(std::isnan(raster.fibre));
  EXPECT_TRUE(std::isnan(raster.fibre_fraction[voxel(raster, 6, 4, 3)]));
  EXPECT_EQ(raster.fibre_fraction[voxel(raster, 6, 0, 0)], 0.0F);
}

TEST(Raster, WhatCannotBe) {
  Diagnostics diagnostics;
  const fabric::Fabric fabric = cell_of(Vec3(0, 0, 0), Vec3(2, 1.5, 1));
  const std::vector<yarn::Body> inside = {test::straight_tube(0.8, 0.5, 4, 24, Vec3(-1, 0.75, 0.5))};
  const std::vector<yarn::Body> outside = {test::straight_tube(0.8, 0.5, 4, 24, Vec3(-1, 0.75, 9))};
  EXPECT_EQ(rasterize(fabric, inside, {.count = 0}, diagnostics).error().kind, Kind::usage);
  EXPECT_EQ(rasterize(fabric, inside, {.count = 2000}, diagnostics).error().kind, Kind::limit);
  EXPECT_EQ(rasterize(fabric, outside, {.count = 10}, diagnostics).error().kind, Kind::geometry);
}

}  // namespace
}  // namespace selvage::fem
