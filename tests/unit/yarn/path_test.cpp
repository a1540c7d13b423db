#include "yarn/path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "nurbs/measure.h"

namespace selvage::yarn {
namespace {

using std::numbers::pi;

TEST(PathTest, PolylineIsSegmentsAndExactArcs) {
  PathRows rows;
  rows.form = PathForm::polyline;
  rows.points = {{0, 0, 0}, {10, 0, 0}, {10, 8, 0}};
  rows.half_sizes = {0.5, 0.5, 0.5};
  const Result<CentreLine> line = make_centre_line(rows);
  ASSERT_TRUE(line.ok());
  const double r = 1.05 * 0.5;
  EXPECT_NEAR(nurbs::arc_length(line->curve), 10 + 8 - 2 * r + pi / 2 * r, 1e-11);
  for (double t = 0; t <= 1.0; t += 0.001) {
    const Vec3 p = nurbs::evaluate(line->curve, t);
    const double on_arc = std::abs((p - Vec3(10 - r, r, 0)).norm() - r);
    if (p.x() > 10 - r && p.y() < r)
      EXPECT_LT(on_arc, 1e-13);
    else
      EXPECT_LT(std::min(std::abs(p.y()), std::abs(p.x() - 10)), 1e-13);
  }
  // The speed is continuous where arc and segment meet.
  for (double knot : nurbs::breakpoints(line->curve.knots, 2)) {
    if (knot <= 0 || knot >= 1) continue;
    const Vec3 before = nurbs::evaluate_jet(line->curve, knot - 1e-9).d1,
               after = nurbs::evaluate_jet(line->curve, knot + 1e-9).d1;
    EXPECT_LT((before - after).norm(), 1e-6 * before.norm());
  }
}

TEST(PathTest, PolylineWithoutRoomOrThatTurnsBackIsRefusedAtItsRow) {
  PathRows rows;
  rows.form = PathForm::polyline;
  rows.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0.9, 1, 0}};
  rows.half_sizes.assign(4, 0.3);
  Result<CentreLine> line = make_centre_line(rows);
  ASSERT_FALSE(line.ok());
  EXPECT_EQ(line.error().place.line, 3);
  rows.points = {{0, 0, 0}, {1, 0, 0}, {0, 0.01, 0}};
  rows.half_sizes.assign(3, 0.001);
  line = make_centre_line(rows);
  ASSERT_FALSE(line.ok());
  EXPECT_EQ(line.error().place.line, 2);
}

TEST(PathTest, ClosedPolylineComesBack) {
  PathRows rows;
  rows.form = PathForm::polyline;
  rows.closed = true;
  rows.points = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  rows.half_sizes.assign(4, 0.2);
  const Result<CentreLine> line = make_centre_line(rows);
  ASSERT_TRUE(line.ok());
  const double r = 1.05 * 0.2;
  EXPECT_EQ(line->curve.points.front(), line->curve.points.back());
  EXPECT_NEAR(nurbs::arc_length(line->curve), 16 - 8 * r + 2 * pi * r, 1e-11);
}

TEST(PathTest, SixPointsOfALoopMakeTenControlPoints) {
  PathRows rows;
  rows.form = PathForm::loop;
  rows.points = {{0, 0, 0}, {1, 3, 0.2}, {2, 4, 0}, {3, 4, 0}, {4, 3, 0.2}, {5, 0, 0}};
  const Result<CentreLine> line = make_centre_line(rows);
  ASSERT_TRUE(line.ok());
  ASSERT_EQ(line->curve.points.size(), 10U);
  // N1, N2 of the second point, by the formula of the method.
  const Vec3 d = (rows.points[2] - rows.points[0]).normalized();
  EXPECT_LT(
      (line->curve.points[1] - (rows.points[1] - d * (rows.points[1] - rows.points[0]).norm() / 4)).norm(),
      1e-15);
  EXPECT_LT(
      (line->curve.points[2] - (rows.points[1] + d * (rows.points[2] - rows.points[1]).norm() / 4)).norm(),
      1e-15);
  EXPECT_GT(line->largest_miss, 0.0);
  EXPECT_LT(line->largest_miss, 0.5);
}

TEST(PathTest, ControlPathIsTheClampedUniformCubic) {
  PathRows rows;
  rows.form = PathForm::control;
  rows.points = {{0, 0, 0}, {1, 1, 0}, {2, -1, 0}, {3, 1, 0}, {4, 0, 1}};
  const Result<CentreLine> line = make_centre_line(rows);
  ASSERT_TRUE(line.ok());
  EXPECT_EQ(line->curve.points, rows.points);
  EXPECT_EQ(line->curve.knots, (std::vector<double>{0, 0, 0, 0, 0.5, 1, 1, 1, 1}));
}

TEST(PathTest, EqualNeighboursAreRefused) {
  PathRows rows;
  rows.points = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  const Result<CentreLine> line = make_centre_line(rows);
  ASSERT_FALSE(line.ok());
  EXPECT_EQ(line.error().place.line, 3);
}

}  // namespace
}  // namespace selvage::yarn
