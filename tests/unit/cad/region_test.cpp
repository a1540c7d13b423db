// Which part of a surface a face is, and where a closed surface is cut open.
#include "cad/region.h"

#include <gtest/gtest.h>

#include <numbers>

#include "cad/seam.h"
#include "nurbs/basis.h"
#include "unit/cad/surfaces.h"

namespace selvage::cad {
namespace {

using nurbs::Curve;
using nurbs::Surface;
using namespace test;

// Parameters of one turn more or less are the same place: a hole is taken out, in whatever turn it and the
// loop round it were given.
TEST(Region, HolesAndOuterLoopsMayBeATurnApart) {
  const Surface s = cylinder(2, 3);
  const double first = s.first_u(), turn = s.last_u() - first;
  for (const double outer : {-0.4, 0.0, 0.4})
    for (const int away : {-1, 0, 1}) {
      const double hole = outer + 0.5 + away;  // in turns
      const Face face = face_of(s, {rectangle(first + outer * turn, first + (outer + 1) * turn, 0.5, 2.5),
                                    rectangle(first + hole * turn, first + (hole + 0.2) * turn, 1, 2)});
      const Region region(face);
      ASSERT_TRUE(region.is_known());
      for (int i = 0; i < 40; ++i)
        for (const double v : {0.2, 0.7, 1.5, 2.2, 2.8}) {
          const double share = (i + 0.5) / 40;
          double in_hole = share - outer - 0.5;
          in_hole -= std::floor(in_hole);
          const bool is_in = v > 0.5 && v < 2.5 && !(v > 1 && v < 2 && in_hole < 0.2);
          EXPECT_EQ(region.contains(first + share * turn, v), is_in)
              << outer << ' ' << away << ' ' << share << ' ' << v;
        }
    }
}

// Far away in the parameters, or round and round: what is there is found, or it is not known; never is it
// looked for without end.
TEST(Region, BoundariesFarAway) {
  const Surface s = cylinder(2, 3);
  const double first = s.first_u(), turn = s.last_u() - first;
  const double far = 1000 * turn;
  const Region region(face_of(s, {rectangle(first + far + 0.2 * turn, first + far + 0.4 * turn, 1, 2)}));
  ASSERT_TRUE(region.is_known());
  EXPECT_TRUE(region.contains(first + 0.3 * turn, 1.5));
  EXPECT_FALSE(region.contains(first + 0.5 * turn, 1.5));
  for (const double wide : {10.0, 1e9, 1e20})
    EXPECT_FALSE(Region(face_of(s, {rectangle(first, first + (wide + 0.5) * turn, 1, 2)})).is_known())
        << wide;
}

// A cone about z, its point at the bottom, and of it the sixth between two of its lines, which file has as
// curves in space only. At the point they have every parameter.
TEST(Region, EdgesThatMeetInAPole) {
  Surface cone = cylinder(2, 3);
  for (int i = 0; i < cone.count_u; ++i) cone.point(i, 0) = Vec3::Zero();
  const double from = 0.7, to = from + std::numbers::pi / 3;
  const auto rim = [](double angle) { return Vec3(2 * std::cos(angle), 2 * std::sin(angle), 3); };
  const double middle = 0.5 * (from + to), weight = std::cos(0.5 * (to - from));
  const Vec3 corner(2 / weight * std::cos(middle), 2 / weight * std::sin(middle), 3);
  Loop loop;
  loop.edges.push_back({straight(Vec3::Zero(), rim(from)), {}, -1});
  loop.edges.push_back({{2, {0, 0, 0, 1, 1, 1}, {rim(from), corner, rim(to)}, {1, weight, 1}}, {}, -1});
  loop.edges.push_back({straight(rim(to), Vec3::Zero()), {}, -1});
  const Region region(face_of(cone, {loop}));
  ASSERT_TRUE(region.is_known());
  for (const double height : {0.02, 0.2, 0.5, 0.9})
    for (int i = 0; i < 200; ++i) {
      const double u = cone.first_u() + (cone.last_u() - cone.first_u()) * (i + 0.5) / 200;
      const double v = cone.first_v() + (cone.last_v() - cone.first_v()) * height;
      const Vec3 p = nurbs::evaluate(cone, u, v);
      const double angle = std::atan2(p.y(), p.x());
      if (std::min(std::abs(angle - from), std::abs(angle - to)) < 1e-3) continue;
      EXPECT_EQ(region.contains(u, v), angle > from && angle < to) << height << ' ' << angle;
    }
}

TEST(Seam, IsInTheGapThatTheBoundaryLeaves) {
  const Surface round = cylinder(2, 3), wavy = wavy_tube();
  for (const Surface& s : {round, wavy, swapped(round)}) {
    const bool in_u = closes(s, true);
    ASSERT_NE(in_u, closes(s, false));
    const double first = in_u ? s.first_u() : s.first_v(), turn = (in_u ? s.last_u() : s.last_v()) - first;
    const double low = in_u ? s.first_v() : s.first_u(), high = in_u ? s.last_v() : s.last_u();
    for (const double start : {-0.3, 0.55, 0.8, -1.3, 1.9}) {  // in turns
      const double from = first + start * turn, to = from + 0.6 * turn;
      const Loop loop = in_u ? rectangle(from, to, low, high) : rectangle(low, high, from, to);
      const Face moved = with_seam_in_gap(face_of(s, {loop}));
      const Surface& m = moved.surface;
      const double begin = in_u ? m.first_u() : m.first_v(), end = in_u ? m.last_u() : m.last_v();
      EXPECT_NEAR(begin, from - 0.2 * turn, 1e-12 * turn);
      EXPECT_NEAR(end - begin, turn, 1e-12 * turn);
      for (int i = 0; i <= 30; ++i)
        for (const double share : {0.0, 0.3, 1.0}) {
          const double t = std::clamp(begin + turn * i / 30, begin, end), other = std::lerp(low, high, share);
          double before = t - turn * std::floor((t - first) / turn);
          before = std::clamp(before, first, first + turn);
          const Vec3 p = in_u ? nurbs::evaluate(m, t, other) : nurbs::evaluate(m, other, t);
          const Vec3 q = in_u ? nurbs::evaluate(s, before, other) : nurbs::evaluate(s, other, before);
          EXPECT_LE((p - q).norm(), 1e-13 * 10);
        }
    }
    // Inside the range, or once round and more: as it was.
    for (const auto& [from, to] : {std::pair(0.1, 0.9), std::pair(-0.2, 1.3)}) {
      const double a = first + from * turn, b = first + to * turn;
      const Face face = face_of(s, {in_u ? rectangle(a, b, low, high) : rectangle(low, high, a, b)});
      EXPECT_EQ(with_seam_in_gap(face).surface, s);
    }
  }
  const Face open = face_of(sheet(), {rectangle(-0.5, 0.5, 0.1, 0.9)});
  EXPECT_EQ(with_seam_in_gap(open).surface, open.surface);
}

}  // namespace
}  // namespace selvage::cad
