// Small shapes, and whether two are the same, for the tests of many folders.
#pragma once

#include <gtest/gtest.h>

#include "nurbs/spline.h"

namespace selvage::test {

inline nurbs::Curve line(const Vec3& a, const Vec3& b) {
  return {1, {0, 0, 1, 1}, {a, b}, {}};
}

inline void expect_same_bits(const nurbs::Surface& a, const nurbs::Surface& b) {
  EXPECT_EQ(a.degree_u, b.degree_u);
  EXPECT_EQ(a.degree_v, b.degree_v);
  EXPECT_EQ(a.count_u, b.count_u);
  EXPECT_EQ(a.count_v, b.count_v);
  EXPECT_EQ(a.knots_u, b.knots_u);
  EXPECT_EQ(a.knots_v, b.knots_v);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.weights, b.weights);
}

}  // namespace selvage::test
