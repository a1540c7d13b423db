// Garment pieces from text: outlines, areas, what is refused and where.
#include "garment/piece.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>

#include "core/source.h"
#include "formats/registry.h"
#include "nurbs/measure.h"

namespace selvage::fabric {
namespace {

struct BuiltPiece {
  std::optional<PieceShape> shape;
  Diagnostics diagnostics;
};

BuiltPiece build(const std::string& body, double tolerance = 0) {
  BuiltPiece built;
  Diagnostics reading;
  const std::optional<Fabric> fabric = formats::txt::descriptor().read_fabric(
      Source::from_memory("fabric 1\nunits cm\npiece p\n" + body + "end\n", "p.txt"), reading);
  EXPECT_TRUE(fabric) << body;
  if (fabric) built.shape = build_piece(*fabric, *pieces_of(*fabric).front(), tolerance, built.diagnostics);
  return built;
}

// The one error of a piece, as the user sees it.
std::string refusal(const std::string& body) {
  const BuiltPiece built = build(body);
  EXPECT_FALSE(built.shape);
  EXPECT_EQ(built.diagnostics.error_count(), 1);
  return built.diagnostics.has_errors() ? to_string(*built.diagnostics.first_error()) : "";
}

TEST(Piece, SquareInEitherDirection) {
  for (const char* body : {"line a 0 0 2 0\nline b 2 0 2 3\nline c 2 3 0 3\nline d 0 3 0 0\n",
                           "line d 0 0 0 3\nline c 0 3 2 3\nline b 2 3 2 0\nline a 2 0 0 0\n"}) {
    const BuiltPiece built = build(body);
    ASSERT_TRUE(built.shape);
    const PieceShape& shape = *built.shape;
    EXPECT_DOUBLE_EQ(shape.area, 6);
    EXPECT_NEAR(shape.perimeter, 10, 1e-13);
    EXPECT_EQ(shape.box.sizes(), Vec2(2, 3));
    ASSERT_EQ(shape.edges.size(), 4U);
    EXPECT_EQ(shape.edges[0].name, body[5] == 'a' ? "a" : "d");
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_EQ(shape.edges[i].curve.points.back(), shape.edges[(i + 1) % 4].curve.points.front());
    // Counter-clockwise: the second line leaves the first to the left.
    const Vec3 first = shape.edges[0].curve.points[1] - shape.edges[0].curve.points[0];
    const Vec3 second = shape.edges[1].curve.points[1] - shape.edges[1].curve.points[0];
    EXPECT_GT(first.cross(second).z(), 0);
  }
}

// A parabola over its chord encloses two thirds of the box; its length has a closed form.
TEST(Piece, ParabolaSegment) {
  const BuiltPiece built = build("curve arc C\n0 0\n1 1\n2 0\nend\nline chord 2 0 0 0\n");
  ASSERT_TRUE(built.shape);
  EXPECT_TRUE(built.diagnostics.messages().empty());
  EXPECT_NEAR(built.shape->area, 4.0 / 3, 1e-14);
  EXPECT_NEAR(built.shape->perimeter, 2 + std::sqrt(5.0) + std::asinh(2.0) / 2, 1e-12);
  EXPECT_NEAR(built.shape->box.max().y(), 1, 1e-15);
  EXPECT_EQ(built.shape->edges[0].fit->shape, nurbs::TurningShape::c);
  EXPECT_LT(built.shape->edges[0].fit->largest_error(), 1e-15);
}

TEST(Piece, ErrorTable) {
  // Four inner points, three of them in line: the cubic cannot meet them all.
  const BuiltPiece built = build("curve c by uniform\n0 0\n1 1\n2 1\n3 1\n4 2\n5 0\nend\nline l 5 0 0 0\n");
  ASSERT_TRUE(built.shape);
  for (const PieceEdge& edge : built.shape->edges) {
    if (!edge.fit) continue;
    ASSERT_EQ(edge.fit->points.size(), 6U);
    double largest = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      const FixedPoint& point = edge.fit->points[i];
      EXPECT_EQ(point.parameter, static_cast<double>(i) / 5);
      EXPECT_NEAR(point.error,
                  (nurbs::evaluate(edge.fit->bezier.solved, static_cast<double>(i) / 5) - point.at).norm(),
                  1e-15);
      EXPECT_LE(point.distance, point.error);
      largest = std::max(largest, point.error);
    }
    EXPECT_EQ(edge.fit->largest_error(), largest);
    EXPECT_GT(largest, 0.05);
    EXPECT_EQ(edge.fit->points.front().error, 0);
    EXPECT_EQ(edge.fit->points.back().error, 0);
  }
}

TEST(Piece, WordThatSaysOtherwiseIsAWarningAtItsLine) {
  const BuiltPiece built = build("curve arc S\n0 0\n1 1\n2 0\nend\nline chord 2 0 0 0\n");
  ASSERT_TRUE(built.shape);
  ASSERT_EQ(built.diagnostics.messages().size(), 1U);
  EXPECT_EQ(to_string(built.diagnostics.messages()[0]),
            "p.txt:4:1: warning: curve 'arc' is called S, but turns one way only, as a C does, and so do "
            "its points");
  const BuiltPiece straight = build("curve arc C\n0 0\n1 0\n2 0\nend\nline b 2 0 2 2\nline c 2 2 0 0\n");
  ASSERT_TRUE(straight.shape);
  ASSERT_EQ(straight.diagnostics.messages().size(), 1U);
  EXPECT_NE(straight.diagnostics.messages()[0].text.find("is straight"), std::string::npos);
}

TEST(Piece, CurveThatDoublesBackIsTold) {
  const BuiltPiece built = build(
      "curve a\n0 0\n1 0.1\n2 0.4\n20 12\nend\nline b 20 12 25 0\nline c 25 0 25 -9\n"
      "line d 25 -9 0 -9\nline e 0 -9 0 0\n");
  ASSERT_TRUE(built.shape);
  ASSERT_EQ(built.diagnostics.messages().size(), 2U);
  EXPECT_NE(
      built.diagnostics.messages()[0].text.find("turns both ways, as an S does, but its points turn one"),
      std::string::npos);
  const std::string& text = built.diagnostics.messages()[1].text;
  EXPECT_NE(text.find("doubles back: between its rows 2 and 3 it runs 0.7"), std::string::npos) << text;
  // Another way to place the points holds it, and is named; so it does.
  const std::string armhole =
      "\n21.5 70.4\n20.2 64\n20.6 57.5\n26 49\nend\nline b 26 49 50 49\nline c 50 49 21.5 70.4\n";
  const BuiltPiece uniform = build("curve a C" + armhole);
  ASSERT_EQ(uniform.diagnostics.messages().size(), 1U);
  EXPECT_EQ(uniform.diagnostics.messages()[0].text,
            "curve 'a' is called C, but turns both ways, as an S does; 'by chord' does not");
  EXPECT_TRUE(build("curve a C by chord" + armhole).diagnostics.messages().empty());
}

// What meets these best runs to and fro far outside of them: without a word that is not taken.
TEST(Piece, ZigzagsAreNotMetAtAnyPrice) {
  const std::string rows = "0 0\n1 1\n0 2\n1 3\n0 4\n1 5\n0 6\nend\nline b 0 6 -3 0\nline c -3 0 0 0\n";
  const BuiltPiece built = build("curve a\n" + rows), met = build("curve a by distance\n" + rows);
  ASSERT_TRUE(built.shape && met.shape);
  EXPECT_TRUE(built.diagnostics.messages().empty());
  EXPECT_FALSE(met.diagnostics.messages().empty());
  EXPECT_LT(built.shape->perimeter, 20);
  for (const PieceEdge& edge : built.shape->edges) {
    if (edge.fit) {
      EXPECT_EQ(edge.fit->by, nurbs::PointParameters::chord);
    }
  }
}

// More points than a cubic meets anywhere are met where it can be.
TEST(Piece, SevenPointsOfACubicAreMet) {
  const nurbs::Bezier cubic = {Vec2(0, 0), Vec2(2, 6), Vec2(9, 7), Vec2(12, 0)};
  std::string rows;
  for (const double t : {0.0, 0.05, 0.3, 0.38, 0.7, 0.96, 1.0}) {
    const Vec2 p = nurbs::evaluate(cubic, t);
    rows += fmt::format("{} {}\n", p.x(), p.y());
  }
  const auto largest = [&](const std::string& word) {
    const BuiltPiece built = build("curve c" + word + "\n" + rows + "end\nline l 12 0 0 0\n");
    return built.shape ? built.shape->edges.front().fit ? built.shape->edges.front().fit->largest_error()
                                                        : built.shape->edges.back().fit->largest_error()
                       : -1.0;
  };
  EXPECT_GT(largest(" by uniform"), 1);
  EXPECT_LT(largest(" by chord"), largest(" by uniform"));
  EXPECT_LT(largest(""), 1e-9);
  EXPECT_EQ(largest(""), largest(" by distance"));
}

TEST(Piece, GapsAreErrorsAtTheLineOfTheNextStart) {
  EXPECT_EQ(refusal("line a 0 0 2 0\nline b 2.5 0 2 2\nline c 2 2 0 0\n"),
            "p.txt:5:1: error: line 'b' starts at (2.5, 0), 0.5 cm from the end of line 'a' at (2, 0)"
            "");
}

TEST(Piece, TurnedLineIsSaidToBeTurned) {
  const BuiltPiece built = build("line a 0 0 2 0\nline b 2 2 2 0\nline c 2 2 0 0\n");
  EXPECT_FALSE(built.shape);
  EXPECT_NE(built.diagnostics.first_error()->text.find("turn its points round"), std::string::npos);
}

TEST(Piece, OpenOutline) {
  const std::string text = refusal("line a 0 0 2 0\nline b 2 0 2 2\nline c 2 2 0 0.5\n");
  EXPECT_NE(
      text.find(
          "p.txt:6:1: error: the outline of piece 'p' is not closed: line 'c' ends at (0, 0.5), 0.5 cm"),
      std::string::npos)
      << text;
}

TEST(Piece, EveryGapIsTold) {
  const BuiltPiece built = build("line a 0 0 2 0\nline b 3 0 2 2\nline c 3 2 0 1\n");
  EXPECT_EQ(built.diagnostics.error_count(), 3);
}

TEST(Piece, EndsWithinTheToleranceAreJoined) {
  const std::string body = "line a 0 0 2 0\nline b 2.01 0 2 2\nline c 2 2 0 0\n";
  EXPECT_FALSE(build(body).shape);
  const BuiltPiece built = build(body, 0.02);
  ASSERT_TRUE(built.shape);
  EXPECT_DOUBLE_EQ(built.shape->area, 2);
  const BuiltPiece gone = build("line a 0 0 2 0\nline b 2.01 0 2 0\nline c 2 0 0 2\nline d 0 2 0 0\n", 0.02);
  ASSERT_FALSE(gone.shape);
  EXPECT_EQ(to_string(*gone.diagnostics.first_error()),
            "p.txt:5:1: error: line 'b' is shorter than the tolerance 0.02 within which ends are joined");
}

TEST(Piece, OutlineThatCrossesItself) {
  const std::string text = refusal("line a 0 0 2 2\nline b 2 2 2 0\nline c 2 0 0 2\nline d 0 2 0 0\n");
  EXPECT_NE(
      text.find("p.txt:6:1: error: the outline of piece 'p' crosses or touches itself: line 'a' and line 'c' "
                "meet at (1, 1)"),
      std::string::npos)
      << text;
}

TEST(Piece, NoArea) {
  EXPECT_NE(refusal("line a 0 0 2 2\nline b 2 2 0 0\n").find("p.txt:3:1: error: piece 'p' encloses no area"),
            std::string::npos);
  EXPECT_NE(refusal("curve a\n0 0\n1 0\n3 0\nend\nline b 3 0 0 0\n").find("no area"), std::string::npos);
}

TEST(Piece, NumbersBeyondTheArithmetic) {
  EXPECT_NE(refusal("line a 0 0 1e300 0\nline b 1e300 0 0 1e300\nline c 0 1e300 0 0\n")
                .find("nothing can be computed"),
            std::string::npos);
  EXPECT_NE(
      refusal("line a 0 0 1e-300 0\nline b 1e-300 0 0 1e-300\nline c 0 1e-300 0 0\n").find("nothing can be"),
      std::string::npos);
  const BuiltPiece large = build("line a 0 0 1e90 0\nline b 1e90 0 0 1e90\nline c 0 1e90 0 0\n");
  ASSERT_TRUE(large.shape);
  EXPECT_NEAR(large.shape->area / 5e179, 1, 1e-12);
}

// One closed curve alone is an outline: a drop.
TEST(Piece, OneClosedCurve) {
  const BuiltPiece built = build("curve drop\n0 0\n2 1\n1 2\n0 0\nend\n");
  ASSERT_TRUE(built.shape);
  EXPECT_EQ(built.shape->edges.size(), 1U);
  EXPECT_GT(built.shape->area, 0);
}

const PieceEdge* edge_named(const PieceShape& shape, std::string_view name) {
  for (const PieceEdge& edge : shape.edges)
    if (edge.name == name) return &edge;
  return nullptr;
}

// Quarters of a circle by rational Beziers: degree 2 with the weights 1, 1/sqrt 2, 1, elevated by hand.
TEST(Piece, RationalControlPointsMakeACircle) {
  const double w = (1 + std::sqrt(2.0)) / 3, a = std::sqrt(2.0) / (1 + std::sqrt(2.0));
  std::string body;
  double x = 2, y = 0;  // begins at (2, 0), of radius 2
  for (int quarter = 0; quarter < 4; ++quarter) {
    body += fmt::format("curve q{} control\n{} {}\n{} {} {}\n{} {} {}\n{} {}\nend\n", quarter, x, y,
                        x - a * y, y + a * x, w, -y + a * x, x + a * y, w, -y, x);
    std::tie(x, y) = std::pair(-y, x);
  }
  const BuiltPiece built = build(body);
  ASSERT_TRUE(built.shape);
  EXPECT_NEAR(built.shape->area, 4 * std::numbers::pi, 1e-8);
  EXPECT_NEAR(built.shape->perimeter, 4 * std::numbers::pi, 1e-11);
  EXPECT_NEAR(built.shape->box.max().x(), 2, 1e-9);
  for (const PieceEdge& edge : built.shape->edges)
    for (const double t : {0.1, 0.37, 0.5, 0.9}) EXPECT_NEAR(nurbs::evaluate(edge.curve, t).norm(), 2, 1e-14);
}

TEST(Piece, SplinesGoThroughAllRows) {
  std::string rows;
  std::vector<Vec3> points;
  for (int i = 0; i <= 40; ++i) {
    points.emplace_back(0.5 * i, 2 * std::sin(0.2 * i) + 0.01 * i * i, 0);
    rows += fmt::format("{} {}{}\n", points.back().x(), points.back().y(), i == 7 ? " 2.5" : "");
  }
  const Vec3 end = points.back();
  for (const char* how : {"", " by uniform", " by centripetal"}) {
    const BuiltPiece built = build(fmt::format(
        "curve c spline{}\n{}end\nline a {} {} 20 -9\nline b 20 -9 0 0\n", how, rows, end.x(), end.y()));
    ASSERT_TRUE(built.shape) << to_string(*built.diagnostics.first_error());
    nurbs::Curve curve = edge_named(*built.shape, "c")->curve;
    if ((curve.points.front() - points.front()).norm() > 1) curve = nurbs::reversed(curve);
    EXPECT_EQ(curve.points.size(), 43U);
    const std::vector<double> breaks = nurbs::breakpoints(curve.knots, 3);
    ASSERT_EQ(breaks.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_LT((nurbs::evaluate(curve, breaks[i]) - points[i]).norm(), 1e-13) << i;
    // The weight of the curve in its row: the sum of the basis functions' shares there.
    ASSERT_TRUE(curve.is_rational());
    nurbs::Curve weights = curve;
    weights.weights.clear();
    for (std::size_t i = 0; i < curve.points.size(); ++i) weights.points[i] = Vec3(curve.weight(i), 0, 0);
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_NEAR(nurbs::evaluate(weights, breaks[i]).x(), i == 7 ? 2.5 : 1.0, 1e-13);
  }
}

TEST(Piece, EditsOfSplines) {
  const std::string body =
      "curve c spline\n0 0\n1 1\n2 1.5\n3 1\n4 0\nend\ncurve d spline\n4 0\n5 -1\n6 1\n8 0\nend\nline a 8 0 "
      "8 -5\n"
      "line b 8 -5 0 -5\nline e 0 -5 0 0\n";
  const BuiltPiece plain = build(body);
  ASSERT_TRUE(plain.shape);
  const auto curve_of = [](const BuiltPiece& built, std::string_view name) {
    nurbs::Curve curve = edge_named(*built.shape, name)->curve;
    return curve.points.front().x() < curve.points.back().x() ? curve : nurbs::reversed(curve);
  };
  // One control point moves; the joint is where it was told to be.
  const nurbs::Curve before = curve_of(plain, "c");
  const nurbs::Curve moved = curve_of(build(body + "edit c point 3 to 2.25 1.75\n"), "c");
  EXPECT_LT((nurbs::evaluate(moved, nurbs::breakpoints(moved.knots, 3)[2]) - Vec3(2.25, 1.75, 0)).norm(),
            1e-14);
  int changed = 0;
  for (std::size_t i = 0; i < before.points.size(); ++i)
    changed += moved.points[i] != before.points[i] ? 1 : 0;
  EXPECT_EQ(changed, 1);
  // A number, and the length of another curve with ease.
  EXPECT_NEAR(nurbs::arc_length(curve_of(build(body + "edit c length 6.5 point 3 along 0 1\n"), "c")), 6.5,
              1e-11);
  const double other = nurbs::arc_length(curve_of(plain, "d"));
  EXPECT_NEAR(
      nurbs::arc_length(curve_of(build(body + "edit c length of p d ease 0.75 point 3 along 0 1\n"), "c")),
      other + 0.75, 1e-11);
  for (const auto& [line, words] :
       {std::pair("edit c point 1 to 1 1",
                  "is an end, where the outline would open: its inner joints are 2 to 4"),
        std::pair("edit c point 9 to 1 1", "does not exist"),
        std::pair("edit x point 2 to 1 1", "no curve 'x'"),
        std::pair("edit a point 2 to 1 1", "as a `spline` it has one in every row"),
        std::pair("edit c length of q d point 3 along 0 1", "no piece 'q'"),
        std::pair("edit c length 1 point 3 along 0 1", "makes it 5.1")}) {
    const std::string told = refusal(body + line + "\n");
    EXPECT_NE(told.find(words), std::string::npos) << told;
    EXPECT_NE(told.find("p.txt:20:1"), std::string::npos) << told;
  }
}

// Two pieces whose lengths follow from each other.
TEST(Piece, LengthsInACircleAreTold) {
  const std::string outline = "curve c spline\n0 0\n1 1\n2 0\nend\nline a 2 0 0 0\n";
  Diagnostics reading, diagnostics;
  const std::optional<Fabric> fabric = formats::txt::descriptor().read_fabric(
      Source::from_memory("fabric 1\npiece p\n" + outline +
                              "edit c length of q c point 2 along 0 1\nend\npiece q\n" + outline +
                              "edit c length of p c point 2 along 0 1\nend\n",
                          "p.txt"),
      reading);
  ASSERT_TRUE(fabric);
  EXPECT_FALSE(build_piece(*fabric, *pieces_of(*fabric)[0], 0, diagnostics));
  EXPECT_NE(diagnostics.first_error()->text.find("its own lengths follow from this piece"),
            std::string::npos);
}

}  // namespace
}  // namespace selvage::fabric
