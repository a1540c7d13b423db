#include "solid/single_precision.h"

#include <gtest/gtest.h>

#include <map>

#include "unit/solid/bodies.h"

namespace selvage::solid {
namespace {

using test::straight;

// A round yarn of diameter 0.2 and length 2 along x, whose middle is as far from the origin along all axes.
yarn::Body rod(double from) {
  return straight("rod", {0.1, 0.1, 32, 4}, Vec3::Constant(from), {1, 0, 0}, {0, 1, 0}, 2.0);
}

Result<SingleSkin> single(const yarn::Body& body) {
  Result<Tessellation> skin = tessellate(body, 1e-3);
  EXPECT_TRUE(skin.ok());
  return in_single_precision(body, std::move(*skin));
}

// How often each directed edge is there more often than the other way.
int unpaired(const SingleSkin& skin) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : skin.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      ++edges[{t[k], t[(k + 1) % 3]}];
      --edges[{t[(k + 1) % 3], t[k]}];
    }
  int count = 0;
  for (const auto& [edge, excess] : edges) count += std::abs(excess);
  return count;
}

TEST(SinglePrecision, NearTheOriginEveryTriangleStays) {
  const yarn::Body body = rod(1.0);
  const Result<Tessellation> skin = tessellate(body, 1e-3);
  ASSERT_TRUE(skin.ok());
  const Result<SingleSkin> result = single(body);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result->triangles, skin->triangles);
  ASSERT_EQ(result->vertices.size(), skin->vertices.size());
  for (std::size_t k = 0; k < skin->vertices.size(); ++k)
    EXPECT_EQ(result->vertices[k], skin->vertices[k].cast<float>());
  EXPECT_EQ(result->spacing, std::ldexp(1.0, 1 - 23));  // of 2 to 4, where x ends
}

TEST(SinglePrecision, FarFromItCornersAreJoinedAndTheYarnStaysClosed) {
  const double far = 1048576;  // floats are 1/8 apart there
  const Result<SingleSkin> result = single(rod(far));
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result->spacing, 0.125);
  EXPECT_LT(result->triangles.size(), single(rod(1.0))->triangles.size());
  for (const auto& t : result->triangles)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NE(result->vertices[t[k]], result->vertices[t[(k + 1) % 3]]);
  EXPECT_EQ(unpaired(*result), 0);
}

TEST(SinglePrecision, WhatItCannotHoldIsAnError) {
  const Result<SingleSkin> nothing = single(rod(1e9));
  ASSERT_FALSE(nothing.ok());
  EXPECT_EQ(nothing.error().kind, Kind::limit);
  EXPECT_EQ(nothing.error().yarn, "rod");
  EXPECT_NE(nothing.error().text.find("nothing is left of yarn 'rod'"), std::string::npos);
  Tessellation huge;
  huge.vertices = {{1e39, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  huge.triangles = {{0, 1, 2}};
  const Result<SingleSkin> beyond = in_single_precision(rod(0), std::move(huge));
  ASSERT_FALSE(beyond.ok());
  EXPECT_NE(beyond.error().text.find("above 3.4e+38"), std::string::npos) << beyond.error().text;
}

TEST(SinglePrecision, TheYarnThatSuffersMostIsTold) {
  PrecisionWatch watch;
  EXPECT_FALSE(watch.warning("STL", Unit::mm));
  yarn::Body body;
  const std::array<std::pair<const char*, double>, 3> yarns = {{{"a", 1e-3}, {"b", 4e-3}, {"c", 2e-3}}};
  for (const auto& [name, spacing] : yarns) {
    body.name = name;
    watch.look(body, spacing, 1e-3);
    EXPECT_EQ(watch.warning("STL", Unit::mm).has_value(), body.name != "a");  // as far apart is enough
  }
  const std::optional<Message> warning = watch.warning("STL", Unit::mm);
  ASSERT_TRUE(warning);
  EXPECT_EQ(warning->severity, Severity::warning);
  EXPECT_EQ(warning->yarn, "b");
  EXPECT_NE(warning->text.find("0.004 mm apart, more than the tolerance 0.001"), std::string::npos)
      << warning->text;
}

}  // namespace
}  // namespace selvage::solid
