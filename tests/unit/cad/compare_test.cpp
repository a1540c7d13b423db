// What is told of two models whose difference is known.
#include "cad/compare.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "cad/natural_border.h"
#include "nurbs/basis.h"
#include "nurbs/restrict.h"
#include "shapes.h"
#include "unit/cad/surfaces.h"

namespace selvage::cad {
namespace {

using nurbs::Surface;
using namespace test;
using Kind = Difference::Kind;

Subject cloth(int yarns) {
  Subject subject;
  for (int k = 0; k < yarns; ++k) {
    subject.model.parts.push_back(test::part_of(
        "yarn" + std::to_string(k + 1), {wavy_tube(k), cylinder(0.1, 0.2, 0, k), cylinder(0.1, 0.2, 3, k)}));
    subject.model.parts.back().color = Color{10, 20, 30};
  }
  subject.yarns = subject.model.parts.size();
  return subject;
}

Comparison compared(const Subject& a, const Subject& b, double tolerance = 0) {
  CompareOptions options;
  options.tolerance = tolerance;
  options.threads = 2;
  return compare(a, b, options);
}

TEST(Compare, EqualModelsHaveNoDifference) {
  const Comparison found = compared(cloth(20), cloth(20));
  EXPECT_TRUE(found.differences.empty());
  EXPECT_EQ(found.equal, 20U);
  EXPECT_EQ(found.a.surfaces, 60U);
  EXPECT_EQ(found.largest, 0);
}

TEST(Compare, OnePointOfOneYarnAmongTwoThousand) {
  const Subject before = cloth(2000);
  Subject after = before;
  after.model.parts[1234].faces[0].surface.point(6, 8).y() += 1e-9;
  const Comparison found = compared(before, after);
  ASSERT_EQ(found.differences.size(), 1U);
  const Difference& d = found.differences[0];
  EXPECT_EQ(d.kind, Kind::reshaped);
  EXPECT_EQ(d.what, Thing::Kind::yarn);
  EXPECT_EQ(d.name, "yarn1235");
  EXPECT_EQ(d.surface, "body");
  ASSERT_TRUE(d.control_point);
  EXPECT_EQ(d.control_point->i, 7);
  EXPECT_EQ(d.control_point->j, 9);
  EXPECT_EQ(d.control_point->changed, 1U);
  EXPECT_NEAR(d.reach.at_least, 1e-9, 3e-13);
  EXPECT_EQ(found.equal, 1999U);
  EXPECT_TRUE(compared(before, after, 2e-9).differences.empty());
  EXPECT_NEAR(compared(before, after, 2e-9).largest, 1e-9, 3e-13);
}

// Far from the tube's other points: no seam that lies elsewhere, and told as the point that it is.
TEST(Compare, OnePointThatIsMovedFar) {
  const Subject before = cloth(1);
  Subject after = before;
  after.model.parts[0].faces[0].surface.point(6, 8).z() += 0.2;
  const Comparison found = compared(before, after);
  ASSERT_EQ(found.differences.size(), 1U);
  ASSERT_TRUE(found.differences[0].control_point);
  EXPECT_EQ(found.differences[0].control_point->changed, 1U);
  EXPECT_NEAR(found.differences[0].reach.at_least, 0.2, 1e-12);
}

TEST(Compare, Moved) {
  const Subject before = cloth(5);
  Subject after = before;
  for (Face& face : after.model.parts[2].faces)
    for (Vec3& p : face.surface.points) p += Vec3(0.5, 0, -2);
  const Eigen::AngleAxisd turn(std::numbers::pi / 6, Vec3(0, 0.6, 0.8));
  for (Face& face : after.model.parts[4].faces)
    for (Vec3& p : face.surface.points) p = turn * p;
  const Comparison found = compared(before, after);
  ASSERT_EQ(found.differences.size(), 2U);
  EXPECT_EQ(found.differences[0].kind, Kind::moved);
  EXPECT_EQ(found.differences[0].name, "yarn3");
  EXPECT_LE((found.differences[0].motion.shift - Vec3(0.5, 0, -2)).norm(), 1e-12);
  EXPECT_EQ(found.differences[0].motion.angle, 0);
  EXPECT_EQ(found.differences[1].kind, Kind::moved);
  EXPECT_NEAR(found.differences[1].motion.angle, 30, 1e-9);
  EXPECT_LE((found.differences[1].motion.axis - Vec3(0, 0.6, 0.8)).norm(), 1e-9);
}

// A cylinder has its seam anywhere; on another axis it is another one.
TEST(Compare, AShapeThatTurnsOnItsOwnAxisIsTheSame) {
  Subject before, after, aside;
  for (Subject* subject : {&before, &after, &aside})
    subject->model.parts.emplace_back().faces.push_back(face_of(cylinder(2, 3), {}));
  for (Vec3& p : after.model.parts[0].faces[0].surface.points) p = Eigen::AngleAxisd(0.65, Vec3::UnitZ()) * p;
  for (Vec3& p : aside.model.parts[0].faces[0].surface.points) p = Eigen::AngleAxisd(0.65, Vec3::UnitX()) * p;
  EXPECT_TRUE(compared(before, after, 1e-9).differences.empty());
  const Comparison found = compared(before, aside, 1e-9);
  ASSERT_EQ(found.differences.size(), 1U);
  EXPECT_EQ(found.differences[0].kind, Kind::moved);
}

TEST(Compare, AddedRemovedRenamedRecoloured) {
  const Subject before = cloth(6);
  Subject after = before;
  after.model.parts[1].name = "other";
  after.model.parts[3].color = Color{1, 2, 3};
  after.model.parts.erase(after.model.parts.begin() + 5);
  after.model.parts.push_back(test::part_of("new", {sheet()}));
  for (Vec3& p : after.model.parts.back().faces[0].surface.points) p += Vec3(100, 0, 0);
  after.yarns = 5;
  const Comparison found = compared(before, after);
  ASSERT_EQ(found.differences.size(), 4U);
  EXPECT_EQ(found.differences[0].kind, Kind::renamed);
  EXPECT_EQ(found.differences[0].name, "yarn2");
  EXPECT_EQ(found.differences[0].other_name, "other");
  EXPECT_EQ(found.differences[1].kind, Kind::recoloured);
  EXPECT_EQ(found.differences[1].name, "yarn4");
  EXPECT_EQ(found.differences[2].kind, Kind::removed);
  EXPECT_EQ(found.differences[2].name, "yarn6");
  EXPECT_EQ(found.differences[3].kind, Kind::added);
  EXPECT_EQ(found.differences[3].name, "new");
  EXPECT_EQ(found.equal, 3U);
}

TEST(Compare, ColoursAreThoseThatAreSeen) {
  Subject before = cloth(2), after = before;
  for (Face& face : before.model.parts[0].faces) face.color = Color{1, 2, 3};
  after.model.parts[0].color = Color{1, 2, 3};
  EXPECT_TRUE(compared(before, after).differences.empty());
  before.model.parts[0].faces[0].color.reset();
  ASSERT_EQ(compared(before, after).differences.size(), 1U);
  EXPECT_EQ(compared(before, after).differences[0].kind, Kind::recoloured);
}

TEST(Compare, OutlinesThatAreDrawnASecondTime) {
  Subject before = cloth(1);
  const nurbs::Curve rim = nurbs::boundary_row(before.model.parts[0].faces[0].surface, false);
  Loop loop;
  loop.edges.push_back({rim, {}, -1});
  before.model.parts[0].faces[0].border = {loop};
  Subject after = before;
  NamedCurve again;
  again.curve = rim;
  for (Vec3& p : again.curve.points) p += Vec3(1e-9, -1e-9, 0);
  after.model.curves = {again};
  EXPECT_TRUE(compared(before, after).differences.empty());
  // A zigzag about a side, which it meets at places in between.
  Subject zigzag = before;
  zigzag.model.parts.push_back(part_of("sheet", {sheet()}));
  Subject straight = zigzag;
  NamedCurve& zig = zigzag.model.curves.emplace_back();
  const nurbs::Curve side = nurbs::boundary_row(zigzag.model.parts.back().faces[0].surface, false);
  zig.curve.degree = 1;
  for (int k = 0; k <= 8; ++k) {
    zig.curve.points.push_back(
        nurbs::evaluate(side, std::lerp(side.first_parameter(), side.last_parameter(), k / 8.0)) +
        Vec3(0, k % 2 == 0 ? 0 : 0.3, 0));
    zig.curve.knots.push_back(k);
  }
  zig.curve.knots.insert(zig.curve.knots.begin(), 0);
  zig.curve.knots.push_back(8);
  ASSERT_EQ(compared(straight, zigzag).differences.size(), 1U);
  EXPECT_EQ(compared(straight, zigzag).differences[0].kind, Kind::added);
  for (Vec3& p : after.model.curves[0].curve.points) p += Vec3(1e-4, 0, 0);
  ASSERT_EQ(compared(before, after).differences.size(), 1U);
  EXPECT_EQ(compared(before, after).differences[0].kind, Kind::added);
}

TEST(Compare, OrderDirectionsSeamsAndMissingNamesAreNoDifference) {
  const Subject before = cloth(7);
  Subject after;
  for (const Part& part : before.model.parts) {
    Part other = part;
    other.name.clear();
    other.color.reset();
    for (Face& face : other.faces) face.name.clear();
    std::swap(other.faces[0], other.faces[2]);
    other.faces[0].surface = swapped(backward_v(other.faces[0].surface));
    other.faces[1].surface = stretched(other.faces[1].surface, 3, 1);
    other.faces[2].surface = reseamed(refined_v(other.faces[2].surface, {0.4}), 0.3);
    after.model.parts.insert(after.model.parts.begin(), other);
  }
  after.yarns = 0;
  const Comparison found = compared(before, after, 1e-9);
  EXPECT_TRUE(found.differences.empty());
  EXPECT_EQ(found.equal, 7U);
  EXPECT_EQ(found.notes.size(), 2U);  // names, colours
  EXPECT_LE(found.largest, 1e-11);
}

TEST(Compare, SurfacesCutAndGroupedInAnotherWay) {
  const Subject before = cloth(3);
  Subject loose;  // every surface a part of its own, the bodies in two pieces
  for (const Part& part : before.model.parts)
    for (std::size_t k = 0; k < 3; ++k) {
      const Surface& s = part.faces[k].surface;
      if (k > 0) {
        loose.model.parts.push_back(test::part_of("", {s}));
        continue;
      }
      loose.model.parts.push_back(test::part_of("", {cut_v(s, 0, 0.61)}));
      loose.model.parts.push_back(test::part_of("", {cut_v(s, 0.61, 1)}));
    }
  const Comparison found = compared(before, loose, 1e-9);
  EXPECT_TRUE(found.differences.empty());
  // The same in one part of four faces, under the yarn's name.
  Subject whole = before;
  for (Part& part : whole.model.parts) {
    const Surface s = part.faces[0].surface;
    part.faces[0].surface = cut_v(s, 0, 0.61);
    part.faces.push_back(part.faces[0]);
    part.faces.back().surface = cut_v(s, 0.61, 1);
  }
  EXPECT_TRUE(compared(before, whole, 1e-9).differences.empty());
  whole.model.parts[1].faces.back().surface.point(3, 3).z() += 0.01;
  const Comparison changed = compared(before, whole, 1e-9);
  ASSERT_EQ(changed.differences.size(), 1U);
  EXPECT_EQ(changed.differences[0].kind, Kind::reshaped);
  EXPECT_EQ(changed.differences[0].name, "yarn2");
  EXPECT_GT(changed.differences[0].reach.at_least, 1e-4);
  EXPECT_LE(changed.differences[0].reach.at_most, 0.012);
}

TEST(Compare, APartThatTheOtherFileHasAsTwo) {
  Subject whole, parted;
  const std::vector<Surface> three = {test::cylinder(1, 2), test::cylinder(1, 3, 4),
                                      test::cylinder(2, 1, 0, 9)};
  whole.model.parts = {test::part_of("shell", three)};
  parted.model.parts = {test::part_of("shell", {three[1]}), test::part_of("", {three[0], three[2]})};
  for (const auto& [a, b] : {std::pair(&whole, &parted), std::pair(&parted, &whole)})
    EXPECT_TRUE(compared(*a, *b, 1e-9).differences.empty());
  parted.model.parts[1].faces[1].surface.point(1, 1).x() += 0.1;
  EXPECT_FALSE(compared(whole, parted, 1e-9).differences.empty());
  EXPECT_FALSE(compared(parted, whole, 1e-9).differences.empty());
}

TEST(Compare, KnotsAndWeightsCount) {
  const Subject before = cloth(2);
  Subject after = before;
  after.model.parts[0].faces[0].surface.knots_v[7] += 1e-9;
  after.model.parts[1].faces[1].surface.weights[4] *= 1 + 1e-9;
  const Comparison found = compared(before, after);
  ASSERT_EQ(found.differences.size(), 2U);
  for (const Difference& d : found.differences) {
    EXPECT_EQ(d.kind, Kind::reshaped);
    EXPECT_LE(d.reach.at_most, 1e-7);
  }
  EXPECT_TRUE(compared(before, after, 1e-7).differences.empty());
}

TEST(Compare, TrimmedFaces) {
  // A square hole's worth of plane: two planes of different size with the same outline are the same face.
  const auto plane = [](double low, double high) {
    Surface s;
    s.degree_u = s.degree_v = 1;
    s.count_u = s.count_v = 2;
    s.knots_u = s.knots_v = {low, low, high, high};
    s.points = {{low, low, 1}, {high, low, 1}, {low, high, 1}, {high, high, 1}};
    return s;
  };
  const auto square = [](double low, double high) {
    Loop loop;
    const std::vector<Vec3> corners = {{low, low, 0}, {high, low, 0}, {high, high, 0}, {low, high, 0}};
    for (std::size_t k = 0; k < 4; ++k) {
      Edge edge;
      edge.flat = line(corners[k], corners[(k + 1) % 4]);
      edge.curve = edge.flat;
      for (Vec3& p : edge.curve.points) p.z() = 1;
      loop.edges.push_back(edge);
    }
    return loop;
  };
  const auto model = [&](double size, double low, double high) {
    Subject subject;
    subject.model.parts = {test::part_of("face", {plane(-size, size)})};
    subject.model.parts[0].faces[0].loops = {square(low, high)};
    return subject;
  };
  EXPECT_TRUE(compared(model(2, -1, 1), model(5, -1, 1), 1e-12).differences.empty());
  const Comparison larger = compared(model(2, -1, 1), model(2, -1, 1.25), 1e-12);
  ASSERT_EQ(larger.differences.size(), 1U);
  // The farthest point of the larger outline from the smaller one: its corner.
  EXPECT_LE(larger.differences[0].reach.at_least, std::sqrt(2) * 0.25 + 1e-9);
  EXPECT_GE(larger.differences[0].reach.at_most, std::sqrt(2) * 0.25 - 1e-9);
  EXPECT_GE(larger.differences[0].reach.at_least, 0.3);
}

TEST(Compare, FacesAreFoundByWhatTheyTakeUpNotByTheirSurfaces) {
  // Squares at steps, on planes that reach far beyond them by another amount in each file.
  const auto part = [](bool backward, double far) {
    Subject subject;
    Part& all = subject.model.parts.emplace_back();
    all.name = "squares";
    for (int n = 0; n < 6; ++n) {
      const int k = backward ? 5 - n : n;
      const double x = 2.0 * k, low = -far * (1 + k % 3), high = far * (2 + k % 2);
      Face& face = all.faces.emplace_back();
      Surface& s = face.surface;
      s.degree_u = s.degree_v = 1;
      s.count_u = s.count_v = 2;
      s.knots_u = s.knots_v = {low, low, high, high};
      s.points = {{low, low, 0}, {high, low, 0}, {low, high, 0}, {high, high, 0}};
      Loop& loop = face.loops.emplace_back();
      const std::vector<Vec3> corners = {{x, 0, 0}, {x + 1, 0, 0}, {x + 1, 1.0 + k, 0}, {x, 1.0 + k, 0}};
      for (std::size_t c = 0; c < 4; ++c) {
        Edge& edge = loop.edges.emplace_back();
        edge.flat = edge.curve = line(corners[c], corners[(c + 1) % 4]);
      }
    }
    return subject;
  };
  EXPECT_TRUE(compared(part(false, 20), part(true, 33), 1e-9).differences.empty());
  Subject changed = part(true, 33);
  for (Edge& edge : changed.model.parts[0].faces[2].loops[0].edges)
    for (Vec3& p : edge.curve.points) p.y() *= 1.01;
  const Comparison found = compared(part(false, 20), changed, 1e-9);
  ASSERT_EQ(found.differences.size(), 1U);
  EXPECT_NEAR(found.differences[0].reach.at_least, 0.04, 0.001);
}

// One file trims a surface, another has just the part of it: of two shells that lie close in each other each
// finds its own, whose control points stand out farther than the face.
TEST(Compare, ATrimmedFaceAndTheSameOneWhole) {
  Subject trimmed, whole;
  for (const double radius : {2.0, 1.8}) {
    Surface all = cylinder(radius, 3);
    for (Vec3& p : all.points) p = Eigen::AngleAxisd(std::numbers::pi / 4, Vec3::UnitZ()) * p;
    const Surface part = nurbs::restricted(all, 0.03, 0.22, 0.1, 0.9);
    trimmed.model.parts.emplace_back().faces.push_back(face_of(all, {natural_border(part, 1e-9)}));
    whole.model.parts.emplace_back().faces.push_back(face_of(part, {}));
  }
  for (const auto& [a, b] : {std::pair(&trimmed, &whole), std::pair(&whole, &trimmed)}) {
    const Comparison found = compared(*a, *b, 1e-6);
    EXPECT_TRUE(found.differences.empty());
    EXPECT_EQ(found.equal, 2U);
  }
}

// A file's edges round a whole surface lie beside its sides, within that file's tolerance; another file has
// the same edges as the surface's boundary. One that was moved is found.
TEST(Compare, AWholeFaceByTheEdgesThatItsFileHas) {
  const Surface part = nurbs::restricted(cylinder(2, 3), 0.03, 0.22, 0.1, 0.9);
  Loop edges = natural_border(part, 1e-9);
  for (Edge& edge : edges.edges) {
    edge.flat = {};
    for (std::size_t k = 1; k + 1 < edge.curve.points.size(); ++k) edge.curve.points[k].z() += 1e-3;
  }
  Subject whole, trimmed;
  whole.model.parts.emplace_back().faces.push_back(face_of(part, {}));
  whole.model.parts[0].faces[0].border = {edges};
  trimmed.model.parts.emplace_back().faces.push_back(face_of(part, {edges}));
  EXPECT_TRUE(compared(whole, trimmed, 1e-6).differences.empty());
  EXPECT_TRUE(compared(trimmed, whole, 1e-6).differences.empty());
  for (Edge& edge : trimmed.model.parts[0].faces[0].loops[0].edges)
    for (std::size_t k = 1; k + 1 < edge.curve.points.size(); ++k) edge.curve.points[k].z() -= 2e-3;
  EXPECT_EQ(compared(whole, trimmed, 1e-6).differences.size(), 1U);
}

TEST(Compare, AYarnThatRunsTheOtherWayIsTheSame) {
  const Subject before = cloth(3);
  Subject after = before;
  Part& part = after.model.parts[1];
  std::swap(part.faces[1], part.faces[2]);
  part.faces[0].surface = reseamed(backward_v(part.faces[0].surface), 0.5);
  for (const double tolerance : {0.0, 1e-9}) {
    const Comparison found = compared(before, after, tolerance);
    EXPECT_TRUE(found.differences.empty());
    ASSERT_EQ(found.notes.size(), 1U);
    EXPECT_EQ(found.notes[0], "a yarn runs the other way: 'yarn2'");
  }
}

TEST(Compare, SwappedNames) {
  const Subject before = cloth(5);
  Subject after = before;
  std::swap(after.model.parts[1].name, after.model.parts[3].name);
  const Comparison found = compared(before, after);
  ASSERT_EQ(found.differences.size(), 2U);
  for (const Difference& d : found.differences) {
    EXPECT_EQ(d.kind, Kind::renamed);
    EXPECT_TRUE(d.is_swapped);
  }
  EXPECT_EQ(found.differences[0].name, "yarn2");
  EXPECT_EQ(found.differences[0].other_name, "yarn4");
  EXPECT_EQ(found.equal, 3U);
  // Three names that went round are three new names.
  std::swap(after.model.parts[1].name, after.model.parts[0].name);
  const Comparison round = compared(before, after);
  ASSERT_EQ(round.differences.size(), 3U);
  for (const Difference& d : round.differences) {
    EXPECT_EQ(d.kind, Kind::renamed);
    EXPECT_FALSE(d.is_swapped);
  }
}

}  // namespace
}  // namespace selvage::cad
