// Areas and volumes of trimmed faces, by what is known of cylinders, cones and spheres.
#include "cad/measure.h"

#include <gtest/gtest.h>

#include <numbers>

#include "cad/feet.h"
#include "cad/region.h"
#include "cad/sampled_curve.h"
#include "cad/seam.h"
#include "nurbs/basis.h"
#include "nurbs/chain.h"
#include "nurbs/conic.h"
#include "nurbs/measure.h"
#include "nurbs/restrict.h"
#include "nurbs/sweep.h"
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

// A sphere of radius 2 about the origin, its poles on z.
Surface ball() {
  const Curve meridian =
      nurbs::elliptic_arc(Vec3::Zero(), 2 * Vec3::UnitX(), 2 * Vec3::UnitZ(), -pi / 2, pi / 2);
  return nurbs::revolved(meridian, Vec3::Zero(), Vec3::UnitZ(), 0, 2 * pi);
}
Loop rim_at(double radius, double height, int turn) {
  Loop rim;
  for (int k = 0; k < 4; ++k)
    rim.edges.push_back(in_space(arc(radius, height, turn * k * pi / 2, turn * (k + 1) * pi / 2)));
  return rim;
}

// Archimedes: a cap of a sphere has the area of the belt round it. Of the two caps the face is the one to the
// left of its boundary, seen from where S_u x S_v points.
TEST(Measure, OfACapOfASphere) {
  const double r = 2;
  const Surface sphere = ball();
  const nurbs::SurfaceJet jet = nurbs::evaluate_jet(sphere, sphere.first_u() + 0.5, sphere.first_v() + 0.5);
  const int out = jet.du.cross(jet.dv).dot(jet.position) > 0 ? 1 : -1;
  for (const double z : {-1.1, 0.0, 0.7})
    for (const int turn : {1, -1}) {
      const Face face = face_of(sphere, {rim_at(std::sqrt(r * r - z * z), z, turn)});
      const std::optional<FaceIntegrals> found = integrals_of(face, Vec3::Zero());
      ASSERT_TRUE(found.has_value());
      // Anticlockwise seen from above, the cap above is to the left for who looks from outside.
      const double height = out * turn > 0 ? r - z : r + z;
      EXPECT_NEAR(found->area, 2 * pi * r * height, 1e-8) << z << ' ' << turn;
      EXPECT_NEAR(std::abs(found->volume), 2 * pi * r * height * r / 3, 1e-8) << z << ' ' << turn;
      const Region region(face);
      ASSERT_TRUE(region.is_known());
      for (const double u : {0.1, 0.4, 0.8})
        for (const double v : {0.05, 0.2, 0.4, 0.6, 0.8, 0.95}) {
          const double pu = std::lerp(sphere.first_u(), sphere.last_u(), u),
                       pv = std::lerp(sphere.first_v(), sphere.last_v(), v);
          const double above = nurbs::evaluate(sphere, pu, pv).z() - z;
          if (std::abs(above) > 0.05) {
            EXPECT_EQ(region.contains(pu, pv), (above > 0) == (out * turn > 0)) << u << ' ' << v;
          }
        }
    }
}

// With one pole alone the face ends there, whichever way its boundary runs; a window in it is taken out.
TEST(Measure, OfTheTipOfACone) {
  const double r = 2, h = 3;
  Surface cone = cylinder(r, h);
  for (int i = 0; i < cone.count_u; ++i) cone.point(i, 0) = Vec3::Zero();
  const double first = cone.first_u(), turn = cone.last_u() - first;
  const auto up_to = [&](double z) { return pi * r * z / h * std::hypot(r, h) * z / h; };
  for (const int way : {1, -1}) {
    const auto whole = integrals_of(face_of(cone, {rim_at(r * 2 / h, 2, way)}), Vec3::Zero());
    ASSERT_TRUE(whole.has_value());
    EXPECT_NEAR(whole->area, up_to(2), 1e-8);
    const auto open =
        integrals_of(face_of(cone, {rim_at(r * 2 / h, 2, way),
                                    rectangle(first + 0.25 * turn, first + 0.5 * turn, 1 / h, 1.5 / h)}),
                     Vec3::Zero());
    ASSERT_TRUE(open.has_value());
    EXPECT_NEAR(open->area, up_to(2) - (up_to(1.5) - up_to(1)) / 4, 1e-8);
  }
}

// An eighth of a ball between two meridians and the equator, known in space alone.
TEST(Feet, AnEighthOfASphere) {
  const double r = 2, from = 0.9, to = from + pi / 2;
  const auto meridian = [&](double a, double low, double high) {
    return nurbs::elliptic_arc(Vec3::Zero(), r * Vec3(std::cos(a), std::sin(a), 0), r * Vec3::UnitZ(), low,
                               high);
  };
  Loop loop;
  loop.edges = {in_space(arc(r, 0, from, to)), in_space(meridian(to, 0, pi / 2)),
                in_space(nurbs::reversed(meridian(from, 0, pi / 2)))};
  Face face = face_of(ball(), {loop});
  give_flats(face, 1e-9);
  ASSERT_EQ(face.loops[0].edges.size(), 4U);  // with the pole
  for (const Edge& edge : face.loops[0].edges) {
    ASSERT_FALSE(edge.flat.points.empty());
    for (const double share : {0.0, 0.13, 0.5, 0.77, 1.0}) {
      const Vec3 p = at_share(face.surface, edge.flat, share);
      EXPECT_NEAR(p.norm(), r, 1e-9);
      const Vec3 due = edge.curve.points.empty() ? Vec3(0, 0, r) : at_share(edge.curve, share);
      EXPECT_LE((p - due).norm(), 3e-9) << share;
    }
  }
  const auto found = integrals_of(face, Vec3::Zero());
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->area, pi * r * r / 2, 1e-7);
}

// What is cut out of a sphere by a plane through its pole, in all sizes, and what remains of it: the pole is
// a place of the boundary like any other. `id`: the edges are directed, as those of solids are.
TEST(Measure, OfASphereWhoseBoundaryRunsThroughAPole) {
  const double r = 2;
  for (const double tilt : {0.3, 1.0, 1.5}) {
    // A circle through (0, 0, r) in the plane at right angles to `normal`.
    const Vec3 normal(std::sin(tilt), 0, std::cos(tilt));
    const double height = r * std::cos(tilt), rim = r * std::sin(tilt);
    const Vec3 x = (r * Vec3::UnitZ() - height * normal) / rim, y = normal.cross(x);
    for (const bool turned : {false, true}) {
      Loop loop;
      for (int k = 0; k < 3; ++k)
        loop.edges.push_back(
            {nurbs::elliptic_arc(height * normal, rim * x, rim * y, k * 2 * pi / 3, (k + 1) * 2 * pi / 3),
             {},
             k});
      if (turned) {
        std::ranges::reverse(loop.edges);
        for (Edge& edge : loop.edges) edge.curve = nurbs::reversed(edge.curve);
      }
      const Surface sphere = ball();
      const nurbs::SurfaceJet jet =
          nurbs::evaluate_jet(sphere, sphere.first_u() + 0.5, sphere.first_v() + 0.5);
      const bool looks_out = jet.du.cross(jet.dv).dot(jet.position) > 0;
      const auto found = integrals_of(face_of(sphere, {loop}), Vec3(1, 2, 3));
      ASSERT_TRUE(found.has_value());
      const double cap = 2 * pi * r * (looks_out == turned ? r + height : r - height);
      EXPECT_NEAR(found->area, cap, 1e-9) << tilt << turned;
      // Over a cap the normals add up to the disc that its rim bounds.
      const Vec3 disc = (turned ? -1 : 1) * pi * rim * rim * normal;
      EXPECT_LE((found->area_vector - disc).norm(), 1e-9) << tilt << turned;
      EXPECT_NEAR(found->volume, ((looks_out ? 1 : -1) * r * cap - Vec3(1, 2, 3).dot(disc)) / 3, 1e-8);
    }
  }
}

// Arcs of another program end beside the pole by rounding, where the surface has no direction.
TEST(Measure, AnEighthOfASphereThatEndsBesideItsPole) {
  const double r = 2;
  for (const Surface& sphere : {ball(), nurbs::transposed(ball())})
    for (int octant = 0; octant < 8; ++octant) {
      const Vec3 x((octant & 1) != 0 ? -r : r, 0, 0), y(0, (octant & 2) != 0 ? -r : r, 0),
          z(0, 0, (octant & 4) != 0 ? -r : r);
      for (const Vec3& off : {Vec3(1e-14, 0, 0), Vec3(0, 1e-14, 0), Vec3(1e-13, 1e-13, 1e-13)}) {
        const auto half = [&](const Vec3& from, const Vec3& to, int k) {
          return nurbs::elliptic_arc(off, from, to, k * pi / 4, (k + 1) * pi / 4);
        };
        Loop loop;
        for (const auto& [from, to] : {std::pair(x, y), std::pair(y, z), std::pair(z, x)})
          for (int k = 0; k < 2; ++k) loop.edges.push_back({half(from, to, k), {}});
        const auto found = integrals_of(face_of(sphere, {loop}), Vec3::Zero());
        ASSERT_TRUE(found.has_value()) << octant;
        EXPECT_NEAR(found->area, pi * r * r / 2, 1e-7) << octant << " " << off.transpose();
      }
    }
}

// A line that winds round a cylinder over its seam leaves its range: nothing is given then.
TEST(Feet, NotBeyondTheRange) {
  const Surface s = cylinder(2, 3);
  Loop loop;
  loop.edges = {in_space(arc(2, 1, -0.5, 0.6)),
                in_space(straight(Vec3(2 * std::cos(0.6), 2 * std::sin(0.6), 1),
                                  Vec3(2 * std::cos(0.6), 2 * std::sin(0.6), 2))),
                in_space(arc(2, 2, 0.6, -0.5)),
                in_space(straight(Vec3(2 * std::cos(0.5), -2 * std::sin(0.5), 2),
                                  Vec3(2 * std::cos(0.5), -2 * std::sin(0.5), 1)))};
  Face face = face_of(s, {loop});
  give_flats(face, 1e-9);
  for (const Edge& edge : face.loops[0].edges) EXPECT_TRUE(edge.flat.points.empty());
  // Nor where the curves are off the surface: they hold, and what is nearest to them does not.
  face = face_of(sheet(), {loop});
  give_flats(face, 1e-9);
  ASSERT_EQ(face.loops[0].edges.size(), 4U);
  for (const Edge& edge : face.loops[0].edges) EXPECT_TRUE(edge.flat.points.empty());
}

// Where neither side of a boundary round a surface ends in a pole, it does not tell which is meant: what
// another kernel measured holds.
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

// A square whose edges miss each other, or its plane, by so much; on a cylinder it does not lie at all.
TEST(Measure, LoosenessOfEdges) {
  const Surface plane = {1, 1, 2, 2, {0, 0, 1, 1}, {0, 0, 1, 1}, {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}},
                         {}};
  const auto looseness = [&](const Vec3& miss, const Surface& surface) {
    const Vec3 a(0, 0, 0), b(1, 0, 0), c(1, 1, 0), d(0, 1, 0);
    Loop loop;
    loop.edges = {in_space(straight(a, b)), in_space(straight(b + miss, c)), in_space(straight(c, d)),
                  in_space(straight(d, a))};
    Part part;
    part.faces = {face_of(surface, {loop})};
    return looseness_of({part});
  };
  EXPECT_EQ(looseness(Vec3::Zero(), plane), 0);
  EXPECT_NEAR(looseness({0, 1e-3, 0}, plane), 1e-3, 1e-15);
  EXPECT_NEAR(looseness({0, 0, -2e-3}, plane), 2e-3, 1e-15);
  Surface twisted = plane;  // its edges (0, 0) .. (1, 0) and (0, 0) .. (0, 1) are the square's
  twisted.points[3].z() = 0.5;
  EXPECT_NEAR(looseness(Vec3::Zero(), twisted), 0.5, 0.2);
  EXPECT_NEAR(looseness(Vec3::Zero(), cylinder(2, 1)), 2, 1e-9);  // (0, 0, 0) is on its axis
}

}  // namespace
}  // namespace selvage::cad
