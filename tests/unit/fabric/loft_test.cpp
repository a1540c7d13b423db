// Sections that change their shape along the yarn, against areas and volumes by hand.
#include "fabric/loft.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "built.h"
#include "core/plane.h"
#include "core/source.h"
#include "formats/registry.h"

namespace selvage::fabric {
namespace {

struct Lofted {
  std::vector<yarn::Body> bodies;
  std::string told;
};

Lofted loft_of(const std::string& text) {
  Diagnostics diagnostics;
  std::optional<Fabric> fabric = formats::txt::descriptor().read_fabric(
      Source::from_memory("fabric 1\nthread t\n tex 100\n density 1.5\nend\n" + text, "l.txt"), diagnostics);
  if (fabric) loft(*fabric, diagnostics);
  Lofted out;
  for (const Message& message : diagnostics.messages()) out.told += to_string(message) + "\n";
  if (fabric && !diagnostics.has_errors()) out.bodies = test::built(*fabric, {});
  return out;
}

std::vector<Vec2> ellipse(double width, double height, int count = 12) {
  std::vector<Vec2> points;
  for (int i = 0; i < count; ++i) {
    const double t = 2 * std::numbers::pi * i / count;
    points.emplace_back(0.5 * width * std::cos(t), 0.5 * height * std::sin(t));
  }
  return points;
}

std::vector<Vec2> kidney() {
  std::vector<Vec2> points = ellipse(1.2, 0.6);
  for (Vec2& p : points) p.y() -= 0.5 * p.x() * p.x();
  return points;
}

std::string outline(const std::string& name, const std::vector<Vec2>& points) {
  std::string text = "outline " + name + "\n";
  for (const Vec2& p : points) text += fmt::format("{} {}\n", p.x(), p.y());
  return text + "end\n";
}

// The closed uniform quadratic: parabolas from one edge's middle to the next, which hold two thirds of the
// triangles that the corners stand out by.
double area(const std::vector<Vec2>& control) {
  std::vector<Vec2> middles;
  const std::size_t n = control.size();
  for (std::size_t i = 0; i < n; ++i) middles.emplace_back(0.5 * (control[i] + control[(i + 1) % n]));
  double twice = twice_area(middles);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 &a = middles[(i + n - 1) % n], &b = middles[i], &c = control[i];
    twice += 2.0 / 3 * cross(Vec2(c - a), Vec2(b - c));
  }
  return 0.5 * twice;
}

std::vector<Vec2> blended(const std::vector<Vec2>& a, const std::vector<Vec2>& b, double share) {
  std::vector<Vec2> out;
  for (std::size_t i = 0; i < a.size(); ++i) out.emplace_back((1 - share) * a[i] + share * b[i]);
  return out;
}

// Straight, one outline, sizes that grow in proportion: a cone's frustum.
TEST(Loft, Cone) {
  const std::vector<Vec2> points = ellipse(1, 0.4);
  const Lofted cone =
      loft_of(outline("o", points) +
              "yarn y t\n path\n 0 0 0 1 0.4 outline o\n 1.5 0 0 2 0.8 outline o\n 3 0 0 3 1.2 outline o\n"
              " end\nend\n");
  ASSERT_EQ(cone.bodies.size(), 1U) << cone.told;

  EXPECT_NEAR(cone.bodies[0].volume, area(points) * 3 * (1 + 3 + 9) / 3.0, 1e-12);
}

// From an ellipse to a kidney along a straight: every section is a blend, its area a quadratic of the share.
TEST(Loft, MorphsFromOutlineToOutline) {
  const std::vector<Vec2> a = ellipse(1, 0.5), b = kidney();
  const std::string blocks = outline("a", a) + outline("b", b);
  const double volume = 2 * (area(a) + 4 * area(blended(a, b, 0.5)) + area(b)) / 6;
  for (const char* rows :
       {" 0 0 0 outline a\n 2 0 0 outline b\n", " 0 0 0 outline a\n 0.5 0 0\n 2 0 0 outline b\n",
        " 0 0 0 outline a\n 0.5 0 0 outline a b 0.25\n 2 0 0 outline b\n",
        " 0 0 0 outline a weight 2\n 2 0 0 outline b weight 2\n"}) {
    const Lofted made = loft_of(blocks + "yarn y t\n path\n" + rows + " end\nend\n");
    ASSERT_EQ(made.bodies.size(), 1U) << made.told;
    EXPECT_NEAR(made.bodies[0].volume, volume, 1e-12) << rows;
  }
}

// On a bent path with weights the surface still goes through the section of each row.
TEST(Loft, PassesThroughTheSectionOfEachRow) {
  const std::vector<Vec2> a = ellipse(0.5, 0.2), b = ellipse(0.3, 0.3);
  const Lofted made =
      loft_of(outline("a", a) + outline("b", b) +
              "yarn y t\n path\n 0 0 0 outline a\n 1 1 0 outline b weight 1.5\n 2 0 0.5 outline a b 0.4\n"
              " 4 0 0 0.6 0.2 30 outline a weight 0.8\n end\nend\n");
  ASSERT_EQ(made.bodies.size(), 1U) << made.told;
  const nurbs::Surface& surface = made.bodies[0].surface;
  ASSERT_FALSE(surface.weights.empty());
  const std::vector<double> at = nurbs::breakpoints(surface.knots_v, 3);
  ASSERT_EQ(at.size(), 4U);
  const std::vector<Vec3> rows = {{0, 0, 0}, {1, 1, 0}, {2, 0, 0.5}, {4, 0, 0}};
  for (std::size_t row = 0; row < 4; ++row) {
    // Extents round the row's point, seen from it: its outline's, in its own plane.
    Vec3 middle = Vec3::Zero();
    double widest = 0;
    for (int i = 0; i < 240; ++i) {
      const Vec3 p = nurbs::evaluate(surface, i / 240.0, at[row]);
      middle += p / 240;
      widest = std::max(widest, (p - rows[row]).norm());
    }
    EXPECT_LT((middle - rows[row]).norm(), 1e-12) << row;
    const std::vector<Vec2> outline = row == 0   ? a
                                      : row == 1 ? b
                                      : row == 2 ? blended(a, b, 0.4)
                                                 : ellipse(0.6, 0.2);
    double expected = 0;
    for (std::size_t i = 0; i < outline.size(); ++i)
      for (int k = 0; k <= 40; ++k) {  // the quadratic over three corners
        const double t = k / 40.0;
        const Vec2 &p = outline[i], &q = outline[(i + 1) % 12], &r = outline[(i + 2) % 12];
        expected = std::max(
            expected, Vec2(0.5 * (1 - t) * (1 - t) * p + (0.5 + t * (1 - t)) * q + 0.5 * t * t * r).norm());
      }
    EXPECT_NEAR(widest, expected, 1e-4) << row;
  }
}

TEST(Loft, BadInput) {
  const std::string a = outline("a", ellipse(1, 0.5)), b = outline("b", ellipse(1, 0.5, 9));
  EXPECT_NE(loft_of(a + b + "yarn y t\n path\n 0 0 0 outline a\n 2 0 0 outline b\n end\nend\n")
                .told.find("outline 'b' has 9 points, and the first one of this yarn has 12"),
            std::string::npos);
  EXPECT_NE(loft_of(a + "yarn y t\n path\n 0 0 0 outline c\n 2 0 0\n end\nend\n").told.find("'c'"),
            std::string::npos);
  EXPECT_NE(
      loft_of(a + "yarn y t\n path control\n 0 0 0 outline a\n 2 0 0\n end\nend\n").told.find("data points"),
      std::string::npos);
  EXPECT_NE(loft_of(a + "yarn y t\n path\n 0 0 0 outline a a 2\n 2 0 0\n end\nend\n")
                .told.find("a share lies between"),
            std::string::npos);
  EXPECT_NE(loft_of("outline a\n 0 0\n 1 0\nend\n").told.find("at least 3 points"), std::string::npos);
  EXPECT_NE(loft_of(a + "yarn y t\n path\n 0 0 0 outline a weight 1000\n 1 0 0 outline a weight 0.001\n"
                        " 2 0 0 outline a weight 1000\n 3 0 0 outline a weight 0.001\n end\nend\n")
                .told.find("bring them nearer to each other"),
            std::string::npos);
}

}  // namespace
}  // namespace selvage::fabric
