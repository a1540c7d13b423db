// Areas and volumes of trimmed faces, by what is known of cylinders, cones and spheres.
#include "cad/measure.h"

#include <gtest/gtest.h>

#include <numbers>

#include "cad/region.h"
#include "cad/sampled_curve.h"
#include "cad/seam.h"
#include "nurbs/basis.h"
#include "nurbs/measure.h"
#include "nurbs/restrict.h"
#include "unit/cad/surfaces.h"

namespace selvage::cad {
namespace {

using nurbs::Curve;
using nurbs::Surface;
using std::numbers::pi;
using namespace test;

Edge in_space(const Curve& curve) {
  return {curve, {}, -1};
}
// A circle about z, or an arc of it of less than a half, from one angle to another.
Curve arc(double radius, double height, double from, double to) {
  const double middle = 0.5 * (from + to), weight = std::cos(0.5 * (to - from));
  const auto at = [&](double r, double a) { return Vec3(r * std::cos(a), r * std::sin(a), height); };
  return {
      2, {0, 0, 0, 1, 1, 1}, {at(radius, from), at(radius / weight, middle), at(radius, to)}, {1, weight, 1}};
}

// The patch of a cylinder between two angles and heights, its edges in space; and over its seam.
TEST(Measure, OfAPatchOfACylinder) {
  const double r = 2, low = 0.4, high = 2.3;
  const Surface s = cylinder(r, 3);
  for (const double from : {0.3, 2.0, 5.9, -0.5}) {
    const double to = from + 1.1;
    const auto corner = [&](double a, double z) { return Vec3(r * std::cos(a), r * std::sin(a), z); };
    Loop loop;
    loop.edges = {in_space(arc(r, low, from, to)), in_space(straight(corner(to, low), corner(to, high))),
                  in_space(arc(r, high, to, from)),
                  in_space(straight(corner(from, high), corner(from, low)))};
    const std::optional<FaceIntegrals> found = integrals_of(face_of(s, {loop}), Vec3(0, 0, 1));
    ASSERT_TRUE(found.has_value());
    const double area = r * 1.1 * (high - low);
    EXPECT_NEAR(found->area, area, 1e-9 * area) << from;
    EXPECT_NEAR(found->volume, r * area / 3, 1e-9 * area) << from;  // its points are r from the axis
    const Vec3 flat =
        r * (high - low) * Vec3(std::sin(to) - std::sin(from), std::cos(from) - std::cos(to), 0);
    EXPECT_LE((found->area_vector - flat).norm(), 1e-9 * area) << from;
  }
}

// An edge that has both: the curve in space holds where the one in the parameters is off it.
TEST(Measure, OfEdgesWithBothCurves) {
  const double r = 2, low = 0.4, high = 2.3;
  const Surface s = cylinder(r, 3);
  const double first = s.first_u(), quarter = 0.25 * (s.last_u() - first);
  const auto at = [&](double height) { return std::lerp(s.first_v(), s.last_v(), height / 3); };
  const auto corner = [&](double a, double z) { return Vec3(r * std::cos(a), r * std::sin(a), z); };
  for (const double off : {0.0, 1e-8, 1e-4, 0.05}) {
    Loop loop = rectangle(first, first + quarter, at(low), at(high + off));
    loop.edges[0].curve = arc(r, low, 0, pi / 2);
    loop.edges[1].curve = straight(corner(pi / 2, low), corner(pi / 2, high));
    loop.edges[2].curve = arc(r, high, pi / 2, 0);
    loop.edges[3].curve = straight(corner(0, high), corner(0, low));
    EXPECT_EQ(flat_holds(s, loop.edges[2]), off < 1e-6) << off;
    const Face face = face_of(s, {loop});
    const std::optional<FaceIntegrals> found = integrals_of(face, Vec3::Zero());
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(found->area, 0.5 * pi * r * (high - low), off < 1e-6 ? 1e-6 : 1e-9) << off;
    const Region region(face);
    EXPECT_TRUE(region.contains(first + 0.5 * quarter, at(high - 1e-3)));
    EXPECT_FALSE(region.contains(first + 0.5 * quarter, at(high + 0.03)));
  }
}

// All round, and a window in it that is given a turn away; the loops in either direction.
TEST(Measure, OfASleeveWithAWindow) {
  const double r = 2;
  const Surface s = cylinder(r, 3);
  const double first = s.first_u(), turn = s.last_u() - first;
  const auto at = [&](double share) { return std::lerp(s.first_v(), s.last_v(), share); };
  const double quarter = 0.25 * turn;  // a quarter of the circle is one of its parameters
  for (const bool turned : {false, true})
    for (const double away : {0.0, turn, -turn}) {
      Loop low, high;
      for (int k = 0; k < 4; ++k) {
        low.edges.push_back(in_space(arc(r, 0.6, k * pi / 2, (k + 1) * pi / 2)));
        high.edges.push_back(in_space(turned ? arc(r, 2.4, k * pi / 2, (k + 1) * pi / 2)
                                             : arc(r, 2.4, -k * pi / 2, -(k + 1) * pi / 2)));
      }
      const Loop window =
          rectangle(first + quarter + away, first + 2 * quarter + away, at(0.4), at(0.6), turned);
      const std::optional<FaceIntegrals> found = integrals_of(face_of(s, {low, high, window}), Vec3::Zero());
      ASSERT_TRUE(found.has_value());
      EXPECT_NEAR(found->area, 2 * pi * r * 1.8 - 0.5 * pi * r * 0.6, 1e-9) << turned << ' ' << away;
    }
}

// Boundaries that cross the knots of their surface where they like: a rectangle of the parameters is the
// surface cut there.
TEST(Measure, OfARectangleOfManySpans) {
  for (const Surface& s :
       {sheet(), refined_v(sheet(), {0.21, 0.22, 0.5, 0.77}), swapped(sheet()), wavy_tube(), cylinder(2, 3)})
    for (const double from : {0.0, 0.13, 0.31}) {
      const double u0 = std::lerp(s.first_u(), s.last_u(), from),
                   u1 = std::lerp(s.first_u(), s.last_u(), from + 0.57),
                   v0 = std::lerp(s.first_v(), s.last_v(), 0.11),
                   v1 = std::lerp(s.first_v(), s.last_v(), 0.93);
      const nurbs::Moments cut = nurbs::moments(nurbs::restricted(s, u0, u1, v0, v1), Vec3(1, 2, 3));
      for (const double turn : {0.0, 1.0, -1.0}) {
        const double shift = closes(s, true) ? turn * (s.last_u() - s.first_u()) : 0;
        const auto found =
            integrals_of(face_of(s, {rectangle(u0 + shift, u1 + shift, v0, v1, turn < 0)}), Vec3(1, 2, 3));
        ASSERT_TRUE(found.has_value());
        EXPECT_NEAR(found->area, cut.area, 1e-8 * cut.area);
        EXPECT_NEAR(found->volume, cut.volume, 1e-8 * cut.area);
        EXPECT_LE((found->area_vector - cut.area_vector).norm(), 1e-8 * cut.area);
      }
    }
}

// Turns without end, and parameters beyond an open range.
TEST(Measure, OfBoundariesThatNobodyMeant) {
  const Surface round = cylinder(2, 3);
  const double turn = round.last_u() - round.first_u();
  for (const double wide : {6.0, 1e4, 1e9, 1e20})
    EXPECT_FALSE(integrals_of(face_of(round, {rectangle(0, wide * turn, 0.5, 1)}), Vec3::Zero()).has_value())
        << wide;
  const Surface open = sheet();
  const auto over = integrals_of(face_of(open, {rectangle(0.2, 0.6, -0.5, 0.5)}), Vec3::Zero()),
             within = integrals_of(face_of(open, {rectangle(0.2, 0.6, 0, 0.5)}), Vec3::Zero());
  ASSERT_TRUE(over && within);
  EXPECT_NEAR(over->area, within->area, 1e-6 * within->area);
}

// The sixth of a cone between two of its lines, which meet in its point.
TEST(Measure, OfASectorOfACone) {
  const double r = 2, h = 3, from = 0.7, to = from + pi / 3;
  Surface cone = cylinder(r, h);
  for (int i = 0; i < cone.count_u; ++i) cone.point(i, 0) = Vec3::Zero();
  const auto rim = [&](double a) { return Vec3(r * std::cos(a), r * std::sin(a), h); };
  Loop loop;
  loop.edges = {in_space(straight(Vec3::Zero(), rim(from))), in_space(arc(r, h, from, to)),
                in_space(straight(rim(to), Vec3::Zero()))};
  const std::optional<FaceIntegrals> found = integrals_of(face_of(cone, {loop}), Vec3::Zero());
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->area, std::hypot(r, h) * r * pi / 6, 1e-9);
  EXPECT_NEAR(found->volume, 0, 1e-9);  // every line of it runs through the origin
}

// A rod with a plane at each end, all of whose faces are trimmed, and a hole along its axis in which a
// smaller one stands: volumes are those of the school.
TEST(Measure, OfASolid) {
  const double h = 3;
  Part part;
  part.kind = Part::Kind::solid;
  const auto add_side = [&](double r, bool inwards) {
    Face& side = part.faces.emplace_back(face_of(cylinder(r, h + 2), {}));
    for (Vec3& p : side.surface.points) p.z() -= 1;
    side.reversed = inwards;
    Loop low, high;
    for (int k = 0; k < 4; ++k) {
      low.edges.push_back(in_space(arc(r, 0, k * pi / 2, (k + 1) * pi / 2)));
      high.edges.push_back(in_space(arc(r, h, -k * pi / 2, -(k + 1) * pi / 2)));
    }
    side.loops = {low, high};
  };
  add_side(2, false);
  add_side(0.5, true);
  for (const double z : {0.0, h}) {
    Surface plane;
    plane.degree_u = plane.degree_v = 1;
    plane.count_u = plane.count_v = 2;
    plane.knots_u = plane.knots_v = {0, 0, 1, 1};
    plane.points = {Vec3(-5, -5, z), Vec3(5, -5, z), Vec3(-5, 5, z), Vec3(5, 5, z)};
    Face& end = part.faces.emplace_back(face_of(plane, {}));
    end.reversed = z == 0;
    for (const double r : {2.0, 0.5}) {
      Loop& loop = end.loops.emplace_back();
      for (int k = 0; k < 4; ++k) loop.edges.push_back(in_space(arc(r, z, k * pi / 2, (k + 1) * pi / 2)));
    }
  }
  const PartMeasures found = measures_of(part);
  ASSERT_TRUE(found.area && found.volume);
  EXPECT_NEAR(*found.volume, pi * (4 - 0.25) * h, 1e-8);
  EXPECT_NEAR(*found.area, 2 * pi * (2.5 * h + 4 - 0.25), 1e-8);
  // Without one of its ends it encloses nothing.
  part.faces.pop_back();
  EXPECT_TRUE(measures_of(part).area.has_value());
  EXPECT_FALSE(measures_of(part).volume.has_value());
}

// Of a cap round a pole the boundary does not tell which side is meant: what another kernel measured holds.
TEST(Measure, WhereTheBoundaryDoesNotTell) {
  Part part;
  Face& face = part.faces.emplace_back(face_of(cylinder(2, 3), {}));
  Loop& rim = face.loops.emplace_back();
  for (int k = 0; k < 4; ++k) rim.edges.push_back(in_space(arc(2, 1, k * pi / 2, (k + 1) * pi / 2)));
  EXPECT_FALSE(integrals_of(face, Vec3::Zero()).has_value());
  EXPECT_FALSE(measures_of(part).area.has_value());
  face.area = 7;
  EXPECT_EQ(measures_of(part).area, 7.0);
}

}  // namespace
}  // namespace selvage::cad
