// Divided faces: their regions fill each face once, and yarns' areas are those of the sections.
#include "cell/faces.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "unit/solid/bodies.h"

namespace selvage::cell {
namespace {

using test::straight;
using test::TubeForm;

const TubeForm round{0.5, 0.5, 64, 4};

double area_of(std::span<const yarn::Body> bodies, const Box3& box, const Cut& cut, const Division& division,
               const FaceRegion& region, int parts) {
  const int axis = axis_of(region.face);
  double twice = 0;
  const auto add = [&](const Vec3& p, const Vec3& q) {
    const Vec3 normal = (p - box.min()).cross(q - box.min());
    twice += is_high(region.face) ? normal[axis] : -normal[axis];
  };
  for (const Outline& outline : region.outlines)
    for (const Side& side : outline) {
      const Edge& edge = division.edges[side.edge];
      if (edge.arc == nullptr) {
        const Vec3 &p = division.corners[edge.from].at, &q = division.corners[edge.to].at;
        side.backward ? add(q, p) : add(p, q);
        continue;
      }
      const ArcCurve curve(bodies[cut.pieces[edge.piece].body], box, *edge.arc);
      for (int k = 0; k < parts; ++k) {
        const Vec3 p = curve.position(curve.at(curve.length() * k / parts)),
                   q = curve.position(curve.at(curve.length() * (k + 1) / parts));
        side.backward ? add(q, p) : add(p, q);
      }
    }
  return twice / 2;
}

struct Divided {
  Cut cut;
  Division division;
};

// Cuts and divides; the regions of every face must add up to it. Areas by (face, body).
std::map<std::pair<int, std::size_t>, double> areas(const std::vector<yarn::Body>& bodies, const Box3& box,
                                                    int parts = 1000) {
  Result<Cut> cut_up = cut(bodies, box, 0.001);
  EXPECT_TRUE(cut_up.ok()) << (cut_up.ok() ? "" : to_string(cut_up.error()));
  if (!cut_up) return {};
  const Result<Division> division = divide_faces(bodies, box, *cut_up);
  EXPECT_TRUE(division.ok()) << (division.ok() ? "" : to_string(division.error()));
  if (!division) return {};
  std::map<std::pair<int, std::size_t>, double> result;
  std::map<int, double> whole;
  for (const FaceRegion& region : division->regions) {
    const double area = area_of(bodies, box, *cut_up, *division, region, parts);
    EXPECT_GT(area, 0);
    result[{region.face, region.body}] += area;
    whole[region.face] += area;
  }
  for (int face = 0; face < face_count; ++face) {
    const Vec3 size = box.sizes();
    const int axis = axis_of(face);
    EXPECT_NEAR(whole[face], size[(axis + 1) % 3] * size[(axis + 2) % 3], 1e-9) << name_of_face(face);
  }
  return result;
}

TEST(Faces, TubesAcross) {
  const std::vector<yarn::Body> bodies = {straight("a", round, {0, 0.7, 0}, {1, 0, 0}, {0, 1, 0}, 8),
                                          straight("b", round, {0, -0.7, 0}, {-1, 0, 0}, {0, 1, 0}, 8)};
  const auto found = areas(bodies, Box3(Vec3(-1, -2, -1), Vec3(1, 2, 1)));
  for (const int face : {0, 1})
    for (const std::size_t body : {std::size_t{0}, std::size_t{1}})
      EXPECT_NEAR((found.at({face, body})), bodies[0].end_area, 1e-5);
  EXPECT_EQ(found.size(), 4U + 6U);
}

TEST(Faces, AnEdgeOfTheBoxRunsThroughTheTube) {
  const std::vector<yarn::Body> bodies = {straight("a", round, Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 8)};
  const auto found = areas(bodies, Box3(Vec3(-1, 0, 0), Vec3(1, 1, 1)));
  EXPECT_NEAR((found.at({0, 0})), bodies[0].end_area / 4, 1e-5);
  EXPECT_NEAR((found.at({1, 0})), bodies[0].end_area / 4, 1e-5);
  EXPECT_NEAR((found.at({2, 0})), 2 * 0.5, 1e-5);  // z low .. radius, along x
  EXPECT_NEAR((found.at({4, 0})), 2 * 0.5, 1e-5);
}

TEST(Faces, ATubeWiderThanTheBoxDividesTheFaces) {
  const std::vector<yarn::Body> bodies = {straight("a", round, Vec3::Zero(), {1, 0, 0}, {0, 1, 0}, 8)};
  const auto found = areas(bodies, Box3(Vec3(-1, -0.3, -1), Vec3(1, 0.3, 1)));
  EXPECT_NEAR((found.at({2, 0})), 2 * 0.8, 1e-5);
  EXPECT_NEAR((found.at({3, 0})), 2 * 0.8, 1e-5);
}

// A ring in the plane of a face is cut to an annulus: matrix inside, too.
TEST(Faces, ARingInAFaceIsAnAnnulus) {
  constexpr double pi = std::numbers::pi;
  const yarn::Body ring =
      test::tube("ring", {0.3, 0.3, 64, 64, true}, [&](double s, double x, double y) -> Vec3 {
        // The cubic runs inside of its control polygon.
        const double radius = (2 + x) * 3 / (2 + std::cos(2 * pi / 64));
        return Vec3(radius * std::cos(2 * pi * s), radius * std::sin(2 * pi * s), y);
      });
  const auto found = areas({ring}, Box3(Vec3(-3, -3, 0.1), Vec3(3, 3, 1)));
  const double half = std::sqrt(0.3 * 0.3 - 0.01);
  const double exact = pi * ((2 + half) * (2 + half) - (2 - half) * (2 - half));
  EXPECT_NEAR((found.at({4, 0})), exact, 1e-5 * exact);
}

// Boxes anywhere about tubes that cross: faces are filled whatever is cut.
TEST(Faces, AnyBox) {
  std::vector<yarn::Body> bodies;
  for (const double at : {-1.5, 0.0, 1.5}) {
    bodies.push_back(straight("x", round, {0, at, 0.55}, {1, 0.05, 0.03}, {0, 1, 0}, 12));
    bodies.push_back(straight("y", round, {at, 0, -0.55}, {0.04, -1, 0.01}, {1, 0, 0}, 12));
  }
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-2.5, 2.5), size(0.4, 4);
  int cells = 0;
  for (int k = 0; k < 60; ++k) {
    const Vec3 low(place(random), place(random), place(random) / 2);
    const Box3 box(low, low + Vec3(size(random), size(random), size(random)));
    const Result<Cut> any = cut(bodies, box, 0.001);
    if (!any) continue;
    SCOPED_TRACE(k);
    ++cells;
    areas(bodies, box, 40);  // neighbours share the arcs: the sum is exact
  }
  EXPECT_GT(cells, 40);
}

TEST(Faces, OverlappingYarnsAreNamed) {
  const std::vector<yarn::Body> bodies = {straight("one", round, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 8),
                                          straight("two", round, {0, 0.8, 0}, {1, 0, 0}, {0, 1, 0}, 8)};
  const Box3 box(Vec3(-1, -2, -1), Vec3(1, 2, 1));
  const Result<Cut> cut_up = cut(bodies, box, 0.001);
  ASSERT_TRUE(cut_up.ok());
  const Result<Division> division = divide_faces(bodies, box, *cut_up);
  ASSERT_FALSE(division.ok());
  EXPECT_NE(division.error().text.find("'one' and 'two' overlap"), std::string::npos);
}

}  // namespace
}  // namespace selvage::cell
