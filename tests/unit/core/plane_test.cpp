#include "core/plane.h"

#include <gtest/gtest.h>

#include "core/groups.h"

namespace selvage {
namespace {

// An L: the square 0 .. 2 without its upper right quarter.
const std::vector<Vec2> bracket = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};

TEST(Plane, AreaAndSense) {
  EXPECT_EQ(twice_area(bracket), 6);
  EXPECT_EQ(twice_area({bracket.rbegin(), bracket.rend()}), -6);
  EXPECT_EQ(cross({1, 0}, {0, 1}), 1);
  std::vector<Vec2> far = bracket;
  for (Vec2& p : far) p += Vec2(1 << 28, 1 << 27);
  EXPECT_EQ(twice_area(far, far.front()), 6);
}

TEST(Plane, WhatAPolygonContains) {
  // At heights of corners too: a ray through a corner counts once.
  for (const double y : {0.25, 0.5, 1.0, 1.5})
    for (const double x : {-0.5, 0.5, 1.5, 2.5})
      EXPECT_EQ(contains(bracket, {x, y}), x > 0 && x < (y < 1 ? 2 : 1)) << x << ' ' << y;
}

TEST(Groups, AreNamedByTheirLeast) {
  Groups groups(6);
  EXPECT_TRUE(groups.join(5, 3));
  EXPECT_TRUE(groups.join(4, 2));
  EXPECT_TRUE(groups.join(4, 5));
  EXPECT_FALSE(groups.join(2, 3));
  std::vector<std::uint32_t> names;
  for (std::size_t k = 0; k < 6; ++k) names.push_back(groups.of(k));
  EXPECT_EQ(names, (std::vector<std::uint32_t>{0, 1, 2, 2, 2, 2}));
}

}  // namespace
}  // namespace selvage
