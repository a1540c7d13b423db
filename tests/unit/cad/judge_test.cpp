// judge and judge_for_receivers: sound models stay silent, each planted fault is found with its place, and
// measures are those that the shapes have by their construction.
#include "cad/judge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "shapes.h"
#include "unit/cad/surfaces.h"

namespace selvage::test {
namespace {

using cad::Face;
using cad::Model;
using cad::Part;

nurbs::Surface bilinear(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  nurbs::Surface s;
  s.degree_u = s.degree_v = 1;
  s.count_u = s.count_v = 2;
  s.knots_u = s.knots_v = {0, 0, 1, 1};
  s.points = {a, b, c, d};
  return s;
}

Face face_at_line(nurbs::Surface surface, int line) {
  Face face;
  face.surface = std::move(surface);
  face.origin.place = {line, 1};
  face.origin.entity = "128 at D" + std::to_string(line);
  return face;
}

Part alone(Face face) {
  Part part;
  part.faces = {std::move(face)};
  return part;
}

// A block of 4 x 2 x 1 whose six faces begin on the lines 10 to 60.
Model block() {
  const auto corner = [](int i, int j, int k) { return Vec3(4.0 * i, 2.0 * j, 1.0 * k); };
  Part part;
  part.kind = Part::Kind::solid;
  int line = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      std::vector<Vec3> points;
      for (int b = 0; b < 2; ++b)
        for (int a = 0; a < 2; ++a)
          points.push_back(axis == 0   ? corner(side, a, b)
                           : axis == 1 ? corner(a, side, b)
                                       : corner(a, b, side));
      part.faces.push_back(face_at_line(bilinear(points[0], points[1], points[2], points[3]), line += 10));
      part.faces.back().reversed = (axis == 1) == (side == 1);
    }
  Model model;
  model.resolution = 1e-6;
  model.parts = {part};
  return model;
}

// The unit square in a plane of 4 x 4, as a hole-free trimmed face on line 5.
Model trimmed() {
  Face face = face_at_line(bilinear({0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {4, 4, 0}), 5);
  const std::array<Vec3, 4> corners = {Vec3(1, 1, 0), Vec3(2, 1, 0), Vec3(2, 2, 0), Vec3(1, 2, 0)};
  cad::Loop loop;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 &a = corners[i], &b = corners[(i + 1) % 4];
    loop.edges.push_back({.curve = line(a, b), .flat = line(a / 4, b / 4)});
  }
  face.loops = {loop};
  Model model;
  model.parts.push_back(alone(face));
  return model;
}

struct Verdict {
  Findings findings;
  cad::Measures measures;

  // Is there a message of this severity with these words, at this line?
  [[nodiscard]] bool says(Severity severity, const std::string& words, int line = 0) const {
    const std::vector<Message> all = findings.messages();
    return std::any_of(all.begin(), all.end(), [&](const Message& message) {
      return message.severity == severity && message.text.find(words) != std::string::npos &&
             (line == 0 || message.place.line == line);
    });
  }
  [[nodiscard]] std::string text() const {
    std::string text;
    for (const Message& message : findings.messages()) text += to_string(message) + "\n";
    return text;
  }
};

Verdict verdict_of(const Model& model, bool is_iges = true) {
  Verdict verdict;
  verdict.measures = cad::judge(model, verdict.findings);
  cad::judge_for_receivers(model, verdict.measures, is_iges, verdict.findings);
  return verdict;
}

constexpr Severity defect = Severity::error, warning = Severity::warning, note = Severity::note;

TEST(Judge, BlockIsSound) {
  const Verdict verdict = verdict_of(block());
  EXPECT_EQ(verdict.findings.defects() + verdict.findings.warnings(), 0) << verdict.text();
  EXPECT_EQ(verdict.measures.faces, 6U);
  EXPECT_EQ(verdict.measures.borders, 24U);
  EXPECT_EQ(verdict.measures.open_borders, 0U);
  EXPECT_EQ(verdict.measures.largest_gap, 0);
  EXPECT_DOUBLE_EQ(verdict.measures.size, 4);
  EXPECT_DOUBLE_EQ(verdict.measures.shortest_border, 1);
  EXPECT_NEAR(*verdict.measures.least_area, 2, 1e-12);
  EXPECT_NEAR(*verdict.measures.largest_area, 8, 1e-12);
}

TEST(Judge, GapIsMeasured) {
  Model model = block();
  model.parts[0].faces[5].surface.points[3].z() += 0.002;  // one corner of the top, upward
  const Verdict verdict = verdict_of(model);
  EXPECT_TRUE(verdict.says(defect, "apart", 60)) << verdict.text();
  EXPECT_TRUE(verdict.says(warning, "SolidWorks and Creo knit")) << verdict.text();
  EXPECT_NEAR(verdict.measures.largest_gap, 0.002, 1e-12);
  ASSERT_TRUE(verdict.measures.gap_at.has_value());
  EXPECT_NEAR((*verdict.measures.gap_at - Vec3(4, 2, 1)).norm(), 0, 0.01);
  // Within the resolution of the file it is none.
  model.resolution = 0.01;
  EXPECT_EQ(verdict_of(model).findings.defects(), 0);
}

// Kernels with tolerant edges sew 0.02 mm, and a ten-thousandth of the size: a warning, and a defect beyond.
TEST(Judge, GapsThatKernelsSew) {
  for (const auto& [gap, severity] : {std::pair(0.0003, warning), std::pair(0.0005, defect)}) {
    Model model = block();  // of size 4: 0.0004
    model.parts[0].faces[5].surface.points[3].z() += gap;
    const Verdict verdict = verdict_of(model);
    EXPECT_TRUE(verdict.says(severity, "apart", 60)) << verdict.text();
    EXPECT_EQ(verdict.findings.is_sound(), severity == warning) << verdict.text();
    model = trimmed();
    model.parts[0].faces[0].loops[0].edges[1].curve.points[1].x() += gap;
    EXPECT_TRUE(verdict_of(model).says(severity, "its boundary is not closed", 5))
        << verdict_of(model).text();
  }
  // Of a model of 4 m: 0.02 mm.
  for (const auto& [gap, severity] : {std::pair(0.019, warning), std::pair(0.021, defect)}) {
    Model model = block();
    for (Face& face : model.parts[0].faces)
      for (Vec3& p : face.surface.points) p *= 1000;
    model.parts[0].faces[5].surface.points[3].z() += gap;
    EXPECT_TRUE(verdict_of(model).says(severity, "apart", 60)) << verdict_of(model).text();
    // In inches it is 25.4 times as much.
    model.units = Unit::inch;
    EXPECT_TRUE(verdict_of(model).says(defect, "apart", 60)) << verdict_of(model).text();
  }
}

TEST(Judge, OneLineAKindHasTheWorst) {
  Model model = block();
  model.parts[0].faces.pop_back();
  model.parts[0].faces.pop_back();
  const Verdict verdict = verdict_of(model);
  const std::vector<Message> summary = verdict.findings.summary();
  const auto open = std::count_if(summary.begin(), summary.end(), [](const Message& message) {
    return message.text.find("has no other face beside it") != std::string::npos;
  });
  EXPECT_EQ(open, 1);
  ASSERT_FALSE(summary.empty());
  EXPECT_EQ(summary[0].severity, defect);
  EXPECT_TRUE(summary[0].text.starts_with("x")) << summary[0].text;
  EXPECT_NE(summary[0].text.find("the worst: "), std::string::npos) << summary[0].text;
  EXPECT_NE(summary[0].text.find("length 4 mm"), std::string::npos) << summary[0].text;  // the longest
  for (std::size_t i = 1; i < summary.size(); ++i) EXPECT_GE(summary[i - 1].severity, summary[i].severity);
}

TEST(Judge, OpenEdgesAreCounted) {
  Model model = block();
  model.parts[0].faces.pop_back();
  const Verdict solid = verdict_of(model);
  EXPECT_EQ(solid.measures.open_borders, 4U);
  EXPECT_EQ(solid.findings.defects(), 4) << solid.text();
  EXPECT_TRUE(solid.says(defect, "the solid is open", 10)) << solid.text();
  model.parts[0].kind = Part::Kind::surfaces;
  const Verdict group = verdict_of(model);
  EXPECT_EQ(group.findings.defects(), 0) << group.text();
  EXPECT_TRUE(group.says(warning, "the group of surfaces is open", 10)) << group.text();
  EXPECT_TRUE(group.says(warning, "the quilt stays open"));
}

// Flat faces in rows, which have their corners in common.
Model grid_of(int rows, int columns, const std::function<Vec3(int i, int j)>& corner) {
  Part part;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i)
      part.faces.push_back(face_at_line(
          bilinear(corner(i, j), corner(i + 1, j), corner(i, j + 1), corner(i + 1, j + 1)), j * columns + i));
  Model model;
  model.parts = {std::move(part)};
  return model;
}

// A round tube without ends.
Model ring_of(int rows, int columns) {
  return grid_of(rows, columns, [&](int i, int j) {
    const double turn = 2 * std::numbers::pi * (i % columns) / columns;
    return Vec3(std::cos(turn), std::sin(turn), static_cast<double>(j) / rows);
  });
}

Model square_across_x(int rows) {
  return grid_of(rows, rows, [&](int i, int j) -> Vec3 { return Vec3(1, i, j) / rows; });
}

// Four times the faces, about four times the work: a border is compared with those beside it, a face with
// those that may be the same. Sixteen times is each with all.
TEST(Judge, WorkGrowsWithTheFaces) {
  const Verdict few = verdict_of(ring_of(16, 48)), many = verdict_of(ring_of(32, 96));
  EXPECT_EQ(few.measures.open_borders, 96U);
  EXPECT_EQ(many.measures.open_borders, 192U);
  EXPECT_EQ(many.measures.borders, 4 * few.measures.borders);
  EXPECT_GT(few.measures.comparisons, few.measures.borders);
  EXPECT_LT(many.measures.comparisons, 8 * few.measures.comparisons);

  const Verdict plane = verdict_of(square_across_x(28)), larger = verdict_of(square_across_x(56));
  EXPECT_GT(plane.measures.comparisons, plane.measures.borders);
  EXPECT_LT(larger.measures.comparisons, 8 * plane.measures.comparisons);
}

// Each copy once, with the one before it in the file, however many there are.
TEST(Judge, ManyCopiesAreFoundAtOnce) {
  const auto copies = [](int count) {
    Model model;
    for (int i = 0; i < count; ++i) model.parts.push_back(alone(face_at_line(sheet(), 10 * (i + 1))));
    return verdict_of(model);
  };
  const Verdict three = copies(3);
  EXPECT_TRUE(three.says(defect, "the same face as 128 at D10", 20)) << three.text();
  EXPECT_TRUE(three.says(defect, "the same face as 128 at D20", 30)) << three.text();
  const Verdict all = copies(1000);
  EXPECT_EQ(all.findings.defects(), 999);
  EXPECT_EQ(all.measures.comparisons, 999U);
}

TEST(Judge, AFaceThatIsTurned) {
  for (const std::size_t turned : {0U, 3U, 5U}) {
    Model model = block();
    Face& face = model.parts[0].faces[turned];
    face.reversed = !face.reversed;
    const Verdict verdict = verdict_of(model);
    EXPECT_EQ(verdict.findings.defects(), 1) << verdict.text();
    EXPECT_TRUE(verdict.says(defect, "it is turned", 10 * static_cast<int>(turned + 1))) << verdict.text();
  }
  // Against their neighbours all are right.
  Model model = block();
  for (Face& face : model.parts[0].faces) face.reversed = !face.reversed;
  const Verdict verdict = verdict_of(model);
  EXPECT_EQ(verdict.findings.defects(), 1);
  EXPECT_TRUE(verdict.says(defect, "inside out: the volume is -8 mm3")) << verdict.text();
  // What does not enclose anything has no outside.
  model.parts[0].kind = Part::Kind::shell;
  EXPECT_EQ(verdict_of(model).findings.defects(), 0);
}

TEST(Judge, OneFaceMayBeOpen) {
  Model model;
  model.parts = {part_of("s", {sheet()})};
  EXPECT_EQ(verdict_of(model).measures.open_borders, 0U);
}

TEST(Judge, SeamNeedsNoNeighbour) {
  Model model;
  const nurbs::Surface side = cylinder(1, 3);
  const auto disc = [](double z) {
    nurbs::Surface s = cylinder(1, 1);
    for (int i = 0; i < s.count_u; ++i) {
      s.point(i, 0) = Vec3(s.point(i, 0).x(), s.point(i, 0).y(), z);
      s.point(i, 1) = Vec3(0, 0, z);
    }
    return s;
  };
  model.parts = {part_of("rod", {side, disc(0), disc(3)})};
  model.parts[0].kind = Part::Kind::solid;
  model.parts[0].faces[1].reversed = true;
  const Verdict verdict = verdict_of(model);
  EXPECT_EQ(verdict.findings.defects(), 0) << verdict.text();
  EXPECT_EQ(verdict.measures.poles, 2U);
  EXPECT_TRUE(verdict.says(warning, "Creo lists surfaces with a pole")) << verdict.text();
  EXPECT_TRUE(verdict.says(note, "is one point, a pole"));
}

TEST(Judge, NearlyClosedSurface) {
  Model model;
  nurbs::Surface tube = wavy_tube();
  model.parts = {part_of("t", {tube})};
  EXPECT_FALSE(verdict_of(model).says(warning, "it is open in"));
  const bool in_u = (tube.point(0, 1) - tube.point(tube.count_u - 1, 1)).norm() == 0;
  for (int k = 0; k < (in_u ? tube.count_v : tube.count_u); ++k)
    (in_u ? tube.point(tube.count_u - 1, k) : tube.point(k, tube.count_v - 1)).z() += 1e-8;
  model.parts = {part_of("t", {tube})};
  const Verdict verdict = verdict_of(model);
  EXPECT_TRUE(verdict.says(warning, std::string("it is open in ") + (in_u ? "u" : "v") + " by 1e-08"))
      << verdict.text();
}

TEST(Judge, FaceThatIsThereTwice) {
  Model model = block();
  Face again = face_at_line(swapped(model.parts[0].faces[2].surface), 99);
  model.parts.push_back(alone(again));
  const Verdict verdict = verdict_of(model);
  EXPECT_TRUE(verdict.says(defect, "128 at D99: the same face as 128 at D30", 99)) << verdict.text();
  EXPECT_EQ(verdict.findings.defects(), 1);
}

// Two groups have the same entity: a habit of some programs, and no defect.
TEST(Judge, AFaceOfTwoGroups) {
  Model model = block();
  model.parts.push_back(alone(model.parts[0].faces[2]));
  const Verdict verdict = verdict_of(model);
  EXPECT_EQ(verdict.findings.defects(), 0) << verdict.text();
  EXPECT_TRUE(verdict.says(note, "it is read twice: two groups have it", 30)) << verdict.text();
}

// Twelve turns of a thread, of which twelve steps see one place each.
TEST(Judge, AreaOfAHelix) {
  constexpr int turns = 12, each = 10, count = turns * each + 1;
  nurbs::Surface flank;
  flank.degree_u = flank.degree_v = 1;
  flank.count_u = 2;
  flank.count_v = count;
  flank.knots_u = {0, 0, 1, 1};
  flank.knots_v = {0};
  for (int j = 0; j < count; ++j) flank.knots_v.push_back(j);
  flank.knots_v.push_back(count - 1);
  for (int j = 0; j < count; ++j) {
    const double turn = 2 * std::numbers::pi * (j % each) / each;
    for (const double z : {0.0, 0.5})
      flank.points.emplace_back(std::cos(turn), std::sin(turn), z + static_cast<double>(j) / each);
  }
  Model model;
  model.parts = {alone(face_at_line(flank, 70))};
  EXPECT_FALSE(verdict_of(model).says(defect, "a face without area")) << verdict_of(model).text();
}

TEST(Judge, FaceWithoutArea) {
  Model model = block();
  model.parts.push_back(alone(face_at_line(bilinear({0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}), 70)));
  EXPECT_TRUE(verdict_of(model).says(defect, "a face without area", 70));
}

TEST(Judge, KnotsAndWeights) {
  Model model = block();
  model.parts[0].faces[1].surface.knots_u = {0, 1, 0, 1};
  EXPECT_TRUE(verdict_of(model).says(defect, "its knots in u are out of order", 20));
  model = block();
  model.parts[0].faces[1].surface.weights = {1, 1, 0, 1};
  EXPECT_TRUE(verdict_of(model).says(defect, "a weight of 0", 20));
  model.parts[0].faces[1].surface.weights = {1, 1, 1e-10, 1};
  EXPECT_TRUE(verdict_of(model).says(warning, "OpenCASCADE takes all weights"));
  model = block();
  nurbs::Surface torn = sheet();
  const auto last = static_cast<std::size_t>(torn.degree_u);
  for (std::size_t i = 0; i <= last + 1; ++i) torn.knots_u[i] = torn.knots_u[0];
  model.parts.push_back(alone(face_at_line(torn, 80)));
  EXPECT_TRUE(verdict_of(model).says(defect, "times, at degree", 80));
}

TEST(Judge, Loops) {
  EXPECT_EQ(verdict_of(trimmed()).findings.defects(), 0) << verdict_of(trimmed()).text();
  Model model = trimmed();
  model.parts[0].faces[0].loops[0].edges[1].curve.points[1].x() += 0.01;
  EXPECT_TRUE(verdict_of(model).says(defect, "its boundary is not closed: 0.01", 5))
      << verdict_of(model).text();
  model = trimmed();
  model.parts[0].faces[0].loops[0].edges[1].flat.points[1].x() = 1.2;
  EXPECT_TRUE(verdict_of(model).says(defect, "leaves the range of its surface", 5))
      << verdict_of(model).text();
  model = trimmed();
  for (cad::Edge& edge : model.parts[0].faces[0].loops[0].edges)
    for (Vec3& p : edge.curve.points) p.z() += 0.5;
  EXPECT_TRUE(verdict_of(model).says(defect, "an edge lies 0.5 mm off its surface", 5))
      << verdict_of(model).text();
}

// Of a closed surface parameters beyond its range are those of another turn.
TEST(Judge, ParametersOfAnotherTurn) {
  nurbs::Surface side = cylinder(1, 3);
  const double turn = side.last_u() - side.first_u(), low = side.first_v(), height = side.last_v() - low;
  const auto at = [&](double u, double v) { return Vec3(side.first_u() + u * turn, low + v * height, 0); };
  const auto loop_from = [&](double shift) {
    cad::Loop loop;
    const std::array<Vec2, 4> corners = {Vec2(0.1, 0.2), Vec2(0.4, 0.2), Vec2(0.4, 0.8), Vec2(0.1, 0.8)};
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec2 &a = corners[i], &b = corners[(i + 1) % 4];
      loop.edges.push_back({.curve = {}, .flat = line(at(a.x() + shift, a.y()), at(b.x() + shift, b.y()))});
    }
    return loop;
  };
  Model model;
  model.parts = {alone(face_at_line(side, 5))};
  for (const double shift : {0.0, -1.0, 1.0}) {
    model.parts[0].faces[0].loops = {loop_from(shift)};
    EXPECT_FALSE(verdict_of(model).says(defect, "leaves the range")) << shift << verdict_of(model).text();
  }
  model.parts[0].faces[0].loops = {loop_from(0)};
  model.parts[0].faces[0].loops[0].edges[1].flat.points[1].y() = low + 1.2 * height;
  EXPECT_TRUE(verdict_of(model).says(defect, "leaves the range of its surface by 0.6 mm", 5))
      << verdict_of(model).text();
}

TEST(Receivers, AccuracyOfCreo) {
  Model model = block();
  EXPECT_FALSE(verdict_of(model).says(warning, "Creo"));
  // A second, tiny block far away: 0.0012 of 2000 is more than half of its edge.
  Part small = model.parts[0];
  for (Face& face : small.faces)
    for (Vec3& p : face.surface.points) p.x() += 2000;
  model.parts.push_back(small);
  const Verdict verdict = verdict_of(model);
  EXPECT_TRUE(verdict.says(warning, "absolute accuracy 0.01 mm", 10)) << verdict.text();
  EXPECT_DOUBLE_EQ(*cad::absolute_accuracy(verdict.measures), 0.01);
}

TEST(Receivers, DegreesResolutionInstancesSlivers) {
  Model model = block();
  EXPECT_FALSE(verdict_of(model).says(warning, "ANSYS"));
  nurbs::Surface high = bilinear({9, 0, 0}, {10, 0, 0}, {9, 1, 0}, {10, 1, 0});
  high.degree_u = 21;
  high.count_u = 22;
  high.knots_u.assign(22, 0);
  high.knots_u.insert(high.knots_u.end(), 22, 1);
  high.points.clear();
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 22; ++i) high.points.emplace_back(9 + i / 21.0, j, 0);
  model.parts.push_back(alone(face_at_line(high, 7)));
  EXPECT_TRUE(verdict_of(model).says(warning, "ANSYS reads degrees up to 20: there is one of 21"));
  model = block();
  model.resolution = 1e-9;
  EXPECT_TRUE(verdict_of(model).says(warning, "OpenCASCADE (and FreeCAD, gmsh)"));
  EXPECT_FALSE(verdict_of(model, false).says(warning, "OpenCASCADE (and FreeCAD, gmsh)"));
  model.resolution = 0.9;
  EXPECT_TRUE(verdict_of(model).says(warning, "merge what is nearer than the file's resolution"));
  model = block();
  model.entities = {{"408", 12}, {"102", 3}, {"128", 6}};
  const Verdict verdict = verdict_of(model);
  EXPECT_TRUE(verdict.says(warning, "the geometry of 12 instances")) << verdict.text();
  EXPECT_TRUE(verdict.says(note, "3 of 102")) << verdict.text();
  model = block();
  model.parts.push_back(
      alone(face_at_line(bilinear({9, 0, 0}, {9 + 1e-3, 0, 0}, {9, 1e-3, 0}, {9 + 1e-3, 1e-3, 0}), 77)));
  EXPECT_TRUE(verdict_of(model).says(warning, "fail on slivers: 128 at D77", 77)) << verdict_of(model).text();
}

}  // namespace
}  // namespace selvage::test
