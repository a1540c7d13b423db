// SVG by hand: exact text of a small piece, and names that XML cannot hold. tests/cli/test_pieces.py asks an
// XML parser.
#include "formats/registry.h"

#include <gtest/gtest.h>

namespace selvage::formats::svg {
namespace {

nurbs::Curve curve_of(std::vector<Vec3> points) {
  nurbs::Curve curve;
  curve.degree = static_cast<int>(points.size()) - 1;
  curve.knots.assign(points.size(), 0.0);
  curve.knots.insert(curve.knots.end(), points.size(), 1.0);
  curve.points = std::move(points);
  return curve;
}

// A chord and an arch over it.
fabric::PieceShape arch(const std::string& name) {
  fabric::PieceShape piece;
  piece.name = name;
  piece.edges.push_back({"chord", {}, curve_of({{0, 0, 0}, {0.1, 0, 0}}), {}});
  piece.edges.push_back({"arch", {}, curve_of({{0.1, 0, 0}, {0.1, 2, 0}, {0, 2, 0}, {0, 0, 0}}), {}});
  piece.box = nurbs::Box2(Vec2(0, 0), Vec2(0.1, 1.5));
  return piece;
}

std::string written(const std::vector<fabric::PieceShape>& pieces, Unit units) {
  Result<OutputFile> output = OutputFile::in_memory();
  SurfaceOptions options;
  options.units = units;
  options.title = "A & B";
  Result<std::unique_ptr<BodyWriter>> writer = descriptor().open_bodies(*output, options);
  for (const fabric::PieceShape& piece : pieces) EXPECT_TRUE((*writer)->add_piece(piece).ok());
  EXPECT_TRUE((*writer)->finish().ok());
  return *output->contents();
}

TEST(Svg, SmallPieceToTheLetter) {
  EXPECT_EQ(
      written({arch("p")}, Unit::cm),
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"11mm\" height=\"25mm\" "
      "viewBox=\"-0.5 -2 1.1 2.5\">\n"
      "<title>A &amp; B</title>\n"
      "<g fill=\"none\" stroke=\"#000000\" stroke-width=\"0.025\" stroke-linejoin=\"round\">\n"
      "<path id=\"p\" d=\"M0 0L0.1 0C0.1 -2 0 -2 0 0Z\"><title>p</title><desc>chord, arch</desc></path>\n"
      "</g>\n</svg>\n");
}

TEST(Svg, HoldsNoYarnsAndIsNeverEmpty) {
  Result<OutputFile> output = OutputFile::in_memory();
  Result<std::unique_ptr<BodyWriter>> writer = descriptor().open_bodies(*output, {});
  yarn::Body body;
  body.name = "warp1";
  const Status refused = (*writer)->add(body);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().kind, Kind::unsupported);
  EXPECT_FALSE((*writer)->finish().ok());
}

TEST(Svg, IsRecognised) {
  EXPECT_TRUE(descriptor().sniff("<?xml version=\"1.0\"?>\n<svg xmlns=\"x\">"));
  EXPECT_FALSE(descriptor().sniff("fabric 1\n# <svg"));
}

}  // namespace
}  // namespace selvage::formats::svg
