// Cut yarns against what the box and the tube say by themselves: every point of a border lies in its face and
// on the surface, corners on the edges, and areas are those of the section.
#include "cell/cut.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "unit/solid/bodies.h"

namespace selvage::cell {
namespace {

using test::straight;
using test::TubeForm;

const TubeForm round_tube{0.5, 0.5, 64, 4};

// Along x.
yarn::Body along_x(const TubeForm& form = round_tube, const Vec3& middle = Vec3::Zero(), double length = 8) {
  return straight("a", form, middle, {1, 0, 0}, {0, 1, 0}, length);
}

Cut cut_one(const yarn::Body& body, const Box3& box) {
  Result<Cut> result = cut({&body, 1}, box, 0.001);
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : to_string(result.error()));
  return result.ok() ? *result : Cut{};
}

// Everything that must hold of any cut; points along arcs too.
void expect_sound(const yarn::Body& body, const Box3& box, const Cut& cut) {
  for (const Piece& piece : cut.pieces) {
    EXPECT_TRUE(box.contains(position(body, piece.inside)));
    for (const Border& border : piece.borders) {
      Vec2 last = border.arcs.back().parameters.back();
      last -= Vec2(border.turns_u * (body.surface.last_u() - body.surface.first_u()), 0);
      EXPECT_LT((last - border.arcs.front().parameters.front()).norm(), 1e-9);
      for (std::size_t a = 0; a < border.arcs.size(); ++a) {
        const Arc& arc = border.arcs[a];
        const ArcCurve curve(body, box, arc);
        ASSERT_GE(arc.parameters.size(), 2U);
        EXPECT_GT(curve.length(), 0);
        if (a > 0) {
          EXPECT_EQ(arc.parameters.front(), border.arcs[a - 1].parameters.back());
        }
        for (int k = 0; k <= 50; ++k) {
          const Vec2 q = curve.at(curve.length() * k / 50);
          const Vec3 on_surface = position(body, q), there = curve.position(q);
          EXPECT_LT((on_surface - there).norm(), 1e-12);
          for (int axis = 0; axis < 3; ++axis) {
            EXPECT_GE(there[axis], box.min()[axis] - 2e-5);  // a chord's depth at a corner
            EXPECT_LE(there[axis], box.max()[axis] + 2e-5);
          }
          if (arc.face < face_count) {
            EXPECT_EQ(there[axis_of(arc.face)], plane_of(box, arc.face));
          }
        }
        if (border.arcs.size() > 1) {
          const Arc& next = border.arcs[(a + 1) % border.arcs.size()];
          const Vec3 corner = position(body, arc.parameters.back());
          for (const int face : {arc.face, next.face})
            EXPECT_NEAR(corner[axis_of(face)], plane_of(box, face), 1e-12);
        }
      }
    }
  }
}

// Of what an arc that is a border by itself goes round, in its face.
double enclosed_area(const yarn::Body& body, const Box3& box, const Arc& arc) {
  const ArcCurve curve(body, box, arc);
  const int axis = axis_of(arc.face);
  double twice = 0;
  constexpr int parts = 4000;
  for (int k = 0; k < parts; ++k) {
    const Vec3 p = curve.position(curve.at(curve.length() * k / parts)),
               q = curve.position(curve.at(curve.length() * (k + 1) / parts));
    twice += p[(axis + 1) % 3] * q[(axis + 2) % 3] - p[(axis + 2) % 3] * q[(axis + 1) % 3];
  }
  return std::abs(twice) / 2;
}

TEST(Cut, ATubeCutAcrossHasTwoRoundBorders) {
  const yarn::Body body = along_x();
  const Box3 box(Vec3(-1, -1, -1), Vec3(1.3, 1, 1));
  const Cut result = cut_one(body, box);
  ASSERT_EQ(result.pieces.size(), 1U);
  expect_sound(body, box, result);
  ASSERT_EQ(result.pieces[0].borders.size(), 2U);
  std::array<int, 6> faces{};
  for (const Border& border : result.pieces[0].borders) {
    ASSERT_EQ(border.arcs.size(), 1U);
    EXPECT_EQ(std::abs(border.turns_u), 1);
    ++faces[static_cast<std::size_t>(border.arcs[0].face)];
    EXPECT_NEAR(enclosed_area(body, box, border.arcs[0]), body.end_area, 1e-6 * body.end_area);
  }
  EXPECT_EQ(faces, (std::array<int, 6>{1, 1, 0, 0, 0, 0}));
}

TEST(Cut, AnObliqueCutIsAnEllipse) {
  const Vec3 way = Vec3(1, 0.5, 0).normalized();
  const yarn::Body body = straight("a", round_tube, Vec3::Zero(), way, {0, 0, 1}, 8);
  const Box3 box(Vec3(-1, -2, -1), Vec3(1, 2, 1));
  const Cut result = cut_one(body, box);
  ASSERT_EQ(result.pieces.size(), 1U);
  expect_sound(body, box, result);
  ASSERT_EQ(result.pieces[0].borders.size(), 2U);
  for (const Border& border : result.pieces[0].borders)
    EXPECT_NEAR(enclosed_area(body, box, border.arcs[0]), body.end_area / way.x(), 1e-5);
}

TEST(Cut, ATubeCutLengthwiseIsADiscWithFourArcs) {
  const yarn::Body body = along_x();
  const Box3 box(Vec3(-1, 0.2, -1), Vec3(1, 2, 1));
  const Cut result = cut_one(body, box);
  ASSERT_EQ(result.pieces.size(), 1U);
  expect_sound(body, box, result);
  ASSERT_EQ(result.pieces[0].borders.size(), 1U);
  const Border& border = result.pieces[0].borders[0];
  EXPECT_EQ(border.turns_u, 0);
  std::multiset<int> faces;
  for (const Arc& arc : border.arcs) faces.insert(arc.face);
  EXPECT_EQ(faces, (std::multiset<int>{0, 1, 2, 2}));
}

TEST(Cut, FourQuartersOfATubeCutByEdges) {
  // An edge of the box runs through the tube: what is inside is a quarter, with borders in four faces.
  const yarn::Body body = along_x();
  for (const double y : {-2.0, 0.1})
    for (const double z : {-2.0, -0.05}) {
      const Box3 box(Vec3(-1, y, z), Vec3(1, y + 2.05, z + 2.02));
      const Cut result = cut_one(body, box);
      expect_sound(body, box, result);
      ASSERT_EQ(result.pieces.size(), 1U);
      std::multiset<int> faces;
      for (const Arc& arc : result.pieces[0].borders[0].arcs) faces.insert(arc.face);
      EXPECT_EQ(faces, (std::multiset<int>{0, 1, y < 0 ? 3 : 2, z < 0 && z < -1 ? 5 : 4}));
    }
}

TEST(Cut, AYarnWiderThanTheBoxIsTwoPieces) {
  const yarn::Body body = along_x();
  const Box3 box(Vec3(-1, -0.3, -1), Vec3(1, 0.25, 1));
  const Cut result = cut_one(body, box);
  expect_sound(body, box, result);
  ASSERT_EQ(result.pieces.size(), 2U);
}

TEST(Cut, EndsInTheFacesOfTheBoxBelongToThem) {
  const yarn::Body body = along_x(round_tube, Vec3::Zero(), 2);
  for (const double off : {0.0, 1e-16, 5e-4, -5e-4}) {
    const Box3 box(Vec3(-1 - off, -1, -1), Vec3(1 + off, 1, 1));
    const Cut result = cut_one(body, box);
    ASSERT_EQ(result.pieces.size(), 1U);
    ASSERT_EQ(result.pieces[0].borders.size(), 2U);
    for (const Border& border : result.pieces[0].borders) {
      ASSERT_EQ(border.arcs.size(), 1U);
      EXPECT_LE(border.arcs[0].face, 1);
      EXPECT_NE(border.arcs[0].along, Arc::Along::through);
    }
  }
}

TEST(Cut, EndsInsideOfTheBoxAreTheYarnsOwn) {
  const yarn::Body body = along_x(round_tube, Vec3::Zero(), 2);
  const Cut result = cut_one(body, Box3(Vec3(-2, -1, -1), Vec3(0.5, 1, 1)));
  ASSERT_EQ(result.pieces.size(), 1U);
  std::multiset<int> faces;
  for (const Border& border : result.pieces[0].borders)
    for (const Arc& arc : border.arcs) faces.insert(arc.face);
  EXPECT_EQ(faces, (std::multiset<int>{1, Arc::own_start}));
}

TEST(Cut, AnEndAskewInAFaceIsRefused) {
  const Vec3 way = Vec3(1, 0.2, 0).normalized();
  const yarn::Body body = straight("slanted", round_tube, 4 * way, way, {0, 0, 1}, 8);
  const Result<Cut> result = cut({&body, 1}, Box3(Vec3(0, -4, -1), Vec3(2, 4, 1)), 0.001);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().kind, Kind::geometry);
  EXPECT_EQ(result.error().yarn, "slanted");
}

TEST(Cut, NoYarnInTheBox) {
  const yarn::Body body = along_x();
  EXPECT_FALSE(cut({&body, 1}, Box3(Vec3(-1, 1, 1), Vec3(1, 2, 2)), 0.001).ok());
  // Its bounds reach the box, itself does not.
  EXPECT_FALSE(cut({&body, 1}, Box3(Vec3(-1, 0.4, 0.4), Vec3(1, 2, 2)), 0.001).ok());
}

TEST(Cut, WhatOnlyGrazesTheBoxIsLeftOut) {
  const std::vector<yarn::Body> bodies = {along_x(), along_x(round_tube, {0, 2, 0})};
  const Result<Cut> result = cut(bodies, Box3(Vec3(-1, 0.4995, -1), Vec3(1, 3, 1)), 0.001);
  ASSERT_TRUE(result.ok());
  ASSERT_EQ(result->pieces.size(), 1U);
  EXPECT_EQ(result->pieces[0].body, 1U);
  ASSERT_EQ(result->notes.size(), 1U);
  EXPECT_EQ(result->notes[0].yarn, "a");
}

TEST(Cut, WhatReachesOutByAHairIsRefused) {
  const yarn::Body body = along_x();
  for (const double hair : {1e-9, 5e-4}) {
    const Result<Cut> result = cut({&body, 1}, Box3(Vec3(-1, -1, -1), Vec3(1, 0.5 - hair, 1)), 0.001);
    ASSERT_FALSE(result.ok());
    EXPECT_NE(result.error().text.find("grazes the cell's face y high"), std::string::npos);
  }
  EXPECT_TRUE(cut({&body, 1}, Box3(Vec3(-1, -1, -1), Vec3(1, 0.498, 1)), 0.001).ok());
}

TEST(Box, EdgesAndFacesKnowEachOther) {
  const Box3 box(Vec3(0, 0, 0), Vec3(1, 2, 3));
  std::set<int> seen;
  for (int a = 0; a < face_count; ++a)
    for (int b = 0; b < face_count; ++b) {
      if (axis_of(a) == axis_of(b)) continue;
      const int edge = edge_between(a, b);
      seen.insert(edge);
      std::array<int, 2> faces = faces_of_edge(edge);
      EXPECT_EQ(std::minmax(faces[0], faces[1]), std::minmax(a, b));
      const Vec3 p = edge_point(box, edge, 0.5);
      EXPECT_EQ(p[axis_of(a)], plane_of(box, a));
      EXPECT_EQ(p[axis_of(b)], plane_of(box, b));
      EXPECT_EQ(p[edge / 4], 0.5);
    }
  EXPECT_EQ(seen.size(), 12U);
}

}  // namespace
}  // namespace selvage::cell
