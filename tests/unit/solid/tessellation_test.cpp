#include "solid/tessellation.h"

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <set>

#include "solid/planar.h"
#include "unit/solid/bodies.h"

namespace selvage::solid {
namespace {

using test::straight;
using test::TubeForm;
using yarn::EndStyle;

using std::numbers::pi;

// Edges that do not have exactly one triangle on each side, running opposite ways.
int count_bad_edges(const Tessellation& skin) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed;
  for (const auto& t : skin.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++directed[{t[k], t[(k + 1) % 3]}];
  int bad = 0;
  for (const auto& [edge, count] : directed) {
    const auto back = directed.find({edge.second, edge.first});
    if (count != 1 || back == directed.end() || back->second != 1) ++bad;
  }
  return bad;
}

double smallest_shape(const Tessellation& skin) {
  double smallest = 1.0;
  for (const auto& t : skin.triangles) {
    const Vec3 a = skin.vertices[t[0]], b = skin.vertices[t[1]], c = skin.vertices[t[2]];
    const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    smallest = std::min(smallest, (b - a).cross(c - a).norm() / longest);
  }
  return smallest;
}

TEST(Tessellation, EveryEndStyleSealsAStraightTube) {
  for (EndStyle style : {EndStyle::patch, EndStyle::fan, EndStyle::planar}) {
    SCOPED_TRACE(std::string(yarn::name_of(style)));
    TubeForm form{0.4, 0.1, 32, 4, false, style};
    const yarn::Body body = straight("tube", form, {1, 2, 3}, {1, 0.3, -0.2}, {0, 0, 1}, 5.0);
    const double exact = pi * 0.4 * 0.1 * 5.0;
    double previous = 0.0;
    for (double chord : {4e-3, 1e-3, 2.5e-4}) {
      Result<Tessellation> skin = tessellate(body, chord);
      ASSERT_TRUE(skin.ok());
      EXPECT_EQ(count_bad_edges(*skin), 0);
      EXPECT_GT(smallest_shape(*skin), 1e-4);
      const double defect = (exact - volume(*skin)) / exact;
      EXPECT_GT(defect, 0.0);
      EXPECT_LT(defect * exact, area(*skin) * chord);
      if (previous > 0.0) {
        EXPECT_LT(defect, previous / 2.5);  // about a quarter: the error goes with the chord
      }
      previous = defect;
      std::set<Skin> kinds(skin->skin.begin(), skin->skin.end());
      EXPECT_EQ(kinds.size(), 3U);
    }
  }
}

TEST(Tessellation, KeepsTheChordError) {
  // Triangles' middles lie within the chord error of the ellipse of half axes 0.4, 0.1.
  const yarn::Body body = straight("tube", {0.4, 0.1, 64, 4}, Vec3::Zero(), {0, 0, 1}, {1, 0, 0}, 2.0);
  const double chord = 1e-3;
  Result<Tessellation> skin = tessellate(body, chord);
  ASSERT_TRUE(skin.ok());
  double farthest = 0.0;
  for (std::size_t k = 0; k < skin->triangles.size(); ++k) {
    if (skin->skin[k] != Skin::side) continue;
    const auto& t = skin->triangles[k];
    const Vec3 p = (skin->vertices[t[0]] + skin->vertices[t[1]] + skin->vertices[t[2]]) / 3.0;
    double nearest = 1.0;
    for (int i = 0; i < 20000; ++i) {
      const double angle = 2.0 * pi * i / 20000;
      nearest = std::min(nearest, std::hypot(p.x() - 0.4 * std::cos(angle), p.y() - 0.1 * std::sin(angle)));
    }
    farthest = std::max(farthest, nearest);
  }
  EXPECT_LT(farthest, chord);
  EXPECT_GT(farthest, chord / 20.0);  // and not wastefully far below
}

TEST(Tessellation, RingHasTheVolumeOfPappus) {
  const yarn::Body body = test::ring("ring", 5.0, 0.5);
  Result<Tessellation> skin = tessellate(body, 1e-4);
  ASSERT_TRUE(skin.ok());
  EXPECT_EQ(count_bad_edges(*skin), 0);
  EXPECT_NEAR(volume(*skin), 2.0 * pi * 5.0 * pi * 0.25, area(*skin) * 1e-4 + 1e-4);
  EXPECT_NEAR(volume(*skin), body.volume, area(*skin) * 1e-4);
  // V - E + F = 0 on a torus, and every vertex is used.
  std::set<std::uint32_t> used;
  for (const auto& t : skin->triangles) used.insert(t.begin(), t.end());
  EXPECT_EQ(used.size(), skin->vertices.size());
  EXPECT_EQ(skin->triangles.size(), 2 * skin->vertices.size());
}

TEST(Tessellation, WithoutFacesItIsOpenAtBothEnds) {
  TubeForm form{1, 1, 16, 4, false, EndStyle::none};
  Result<Tessellation> skin =
      tessellate(straight("open", form, Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 4.0), 0.05);
  ASSERT_TRUE(skin.ok());
  int per_row = 0;
  for (const Vec3& p : skin->vertices) per_row += std::abs(p.x() + 2.0) < 1e-12 ? 1 : 0;
  EXPECT_EQ(count_bad_edges(*skin), 2 * per_row);
}

TEST(Tessellation, AMovedFaceKeepsItsOwnEdge) {
  for (EndStyle style : {EndStyle::patch, EndStyle::fan}) {
    yarn::Body body = straight("tube", {0.4, 0.4, 32, 4, false, style}, {1, 1, 1}, {1, 0, 0}, {0, 1, 0}, 2.0);
    for (Vec3& p : body.end.surface.points) p.x() += 1e-6;
    Result<Tessellation> skin = tessellate(body, 0.01);
    ASSERT_TRUE(skin.ok());
    EXPECT_GT(count_bad_edges(*skin), 0);
  }
}

TEST(Tessellation, CornersOnAStraightSideLeaveNoFlatTriangle) {
  // A square section whose quarters meet in the middle of its sides or at its corners, degree 1 round.
  for (int shift : {0, 1}) {
    yarn::GridNet net;
    net.sections = 4;
    net.degree_round = 1;
    net.per_section = 8;
    const std::array<Vec2, 8> outline = {Vec2(1, 0),  Vec2(1, 1),   Vec2(0, 1),  Vec2(-1, 1),
                                         Vec2(-1, 0), Vec2(-1, -1), Vec2(0, -1), Vec2(1, -1)};
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 8; ++i) {
        const Vec2& p = outline[static_cast<std::size_t>((i + shift) % 8)];
        net.points.emplace_back(p.x(), p.y(), j);
      }
    yarn::Body body;
    body.name = "square";
    ASSERT_TRUE(yarn::fill_from_grid(body, net).ok());
    for (EndStyle style : {EndStyle::patch, EndStyle::planar}) {
      ASSERT_TRUE(yarn::finish(body, style).ok());
      Result<Tessellation> skin = tessellate(body, 0.05);
      ASSERT_TRUE(skin.ok());
      EXPECT_EQ(count_bad_edges(*skin), 0);
      EXPECT_GT(smallest_shape(*skin), 1e-3);
      EXPECT_NEAR(volume(*skin), 4.0 * 3.0, 1e-12);
    }
  }
}

TEST(Tessellation, RefusesWhatHasNoPoints) {
  EXPECT_FALSE(tessellate(yarn::Body{}, 0.1).ok());
  yarn::Body body = straight("nan", {1, 1, 16, 4}, Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 4.0);
  EXPECT_EQ(tessellate(body, 1e-15).error().kind, Kind::limit);
  body.surface.points[3].x() = std::nan("");
  Result<Tessellation> skin = tessellate(body, 0.1);
  ASSERT_FALSE(skin.ok());
  EXPECT_EQ(skin.error().kind, Kind::geometry);
  EXPECT_EQ(skin.error().yarn, "nan");
}

TEST(NarrowestSection, IsTheThinDirectionOfAnEightToo) {
  const Vec3 middle(3, 3, 3);
  yarn::Body body = straight("flat", {0.4, 0.1, 64, 4}, middle, {1, 1, 0}, {0, 0, 1}, 2.0);
  EXPECT_NEAR(yarn::narrowest_section(body), 0.2, 1e-3);
  // Turned over on one side of the middle, so that the halves' areas cancel.
  for (Vec3& p : body.surface.points)
    if ((p - middle).dot(Vec3(1, -1, 0)) < 0.0) p.z() = 2.0 * middle.z() - p.z();
  EXPECT_NEAR(yarn::narrowest_section(body), 0.2, 0.02);
  for (Vec3& p : body.surface.points) p.z() = middle.z();
  EXPECT_DOUBLE_EQ(yarn::narrowest_section(body), yarn::widest_section(body));
}

std::vector<PlanarSegment> border_of(const std::vector<Vec2>& outline) {
  std::vector<PlanarSegment> border;
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (std::uint32_t k = 0; k < n; ++k) border.push_back({k, (k + 1) % n, 0, -1});
  return border;
}

TEST(PlanarEnd, NonConvexOutlines) {
  // An L, a comb, and a star: the triangles' areas add up to the outline's, none is turned over.
  std::vector<std::vector<Vec2>> outlines = {
      {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},
      {{0, 0}, {5, 0}, {5, 3}, {4, 3}, {4, 1}, {3, 1}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}},
      {}};
  for (int i = 0; i < 40; ++i) {
    const double r = i % 2 == 0 ? 1.0 : 0.2, angle = 2.0 * pi * i / 40;
    outlines[2].emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  for (const auto& outline : outlines) {
    double whole = 0.0, sum = 0.0;
    for (std::size_t k = 0; k < outline.size(); ++k) {
      const Vec2 &a = outline[k], &b = outline[(k + 1) % outline.size()];
      whole += 0.5 * (a.x() * b.y() - a.y() * b.x());
    }
    const Result<PlanarTriangles> made = triangulate(outline, border_of(outline));
    ASSERT_TRUE(made.ok());
    const auto& triangles = made->triangles;
    EXPECT_EQ(triangles.size(), outline.size() - 2);
    for (const auto& t : triangles) {
      const Vec2 ab = outline[t[1]] - outline[t[0]], ac = outline[t[2]] - outline[t[0]];
      const double part = 0.5 * (ab.x() * ac.y() - ab.y() * ac.x());
      EXPECT_GT(part, 0.0);
      sum += part;
    }
    EXPECT_NEAR(sum, whole, 1e-12);
  }
}

// A racetrack's straight sides as rounding leaves them: no outline that crosses itself.
TEST(PlanarEnd, StraightSidesWithRounding) {
  std::vector<Vec2> outline;
  const Vec2 along(std::cos(0.7), std::sin(0.7)), up(-along.y(), along.x());
  for (int i = 0; i <= 24; ++i) outline.emplace_back(along * (i / 24.0) - up * 0.1);
  for (int i = 1; i < 8; ++i)
    outline.emplace_back(along * (1.0 + 0.1 * std::sin(pi * i / 8)) - up * (0.1 * std::cos(pi * i / 8)));
  for (int i = 24; i >= 0; --i) outline.emplace_back(along * (i / 24.0) + up * 0.1);
  const Result<PlanarTriangles> made = triangulate(outline, border_of(outline));
  ASSERT_TRUE(made.ok());
  EXPECT_EQ(made->triangles.size(), outline.size() - 2);
}

TEST(PlanarEnd, ACrossedOutlineIsRefused) {
  const std::vector<std::vector<Vec2>> outlines = {
      {{0, 0}, {1, 1}, {1, 0}, {0, 1}}, {{0, 0}, {1, 1}}, {{0, 0}, {1, 1}, {2, 2}, {3, 3}}};
  for (const auto& outline : outlines) EXPECT_FALSE(triangulate(outline, border_of(outline)).ok());
}

}  // namespace
}  // namespace selvage::solid
