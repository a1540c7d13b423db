// The reader: our own files bit for bit, and texts made by hand whose meaning is known.
#include "formats/iges/reader.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/iges/bodies.h"
#include "formats/iges/files.h"
#include "formats/iges/reading.h"

namespace selvage::test {

namespace {

void expect_same_bits(const nurbs::Surface& a, const nurbs::Surface& b) {
  EXPECT_EQ(a.degree_u, b.degree_u);
  EXPECT_EQ(a.degree_v, b.degree_v);
  EXPECT_EQ(a.count_u, b.count_u);
  EXPECT_EQ(a.count_v, b.count_v);
  EXPECT_EQ(a.knots_u, b.knots_u);
  EXPECT_EQ(a.knots_v, b.knots_v);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.weights, b.weights);
}

TEST(IgesReader, OwnYarnsComeBackBitForBit) {
  Wave rational;
  rational.weight_step = 0.25;
  rational.y = 3;
  std::vector<yarn::Body> bodies = plain_weave(yarn::EndStyle::patch);
  bodies.push_back(wave("heavy", rational, yarn::EndStyle::fan));
  bodies.push_back(ring("loop"));
  const IgesReading reading = read_iges(iges_bytes(bodies, surfaces(Unit::cm)));
  ASSERT_TRUE(reading.model) << reading.text();
  EXPECT_EQ(reading.text(), "");
  const cad::Model& model = *reading.model;
  EXPECT_EQ(model.units, Unit::cm);
  ASSERT_EQ(model.parts.size(), bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const cad::Part& part = model.parts[i];
    const yarn::Body& body = bodies[i];
    EXPECT_EQ(part.name, body.name);
    EXPECT_EQ(part.kind, cad::Part::Kind::surfaces);
    EXPECT_EQ(part.color, body.color);
    EXPECT_EQ(part.level, static_cast<int>(body.role) + 1);
    EXPECT_EQ(model.levels.at(part.level), yarn::name_of(body.role));
    ASSERT_EQ(part.faces.size(), body.closed_along ? 1U : 3U);
    if (body.closed_along) {
      expect_same_bits(part.faces[0].surface, body.surface);
      continue;
    }
    expect_same_bits(part.faces[body.inward ? 0 : 1].surface, body.surface);
    expect_same_bits(part.faces[body.inward ? 1 : 0].surface, body.start.surface);
    expect_same_bits(part.faces[2].surface, body.end.surface);
    for (const cad::Face& face : part.faces) EXPECT_EQ(face.name, body.name);
  }
  EXPECT_EQ(model.entities.at("128"), 5 * 3 + 1U);
  EXPECT_TRUE(model.unknown.empty());
}

TEST(IgesReader, HeaderComesBack) {
  formats::SurfaceOptions options = surfaces(Unit::inch);
  options.title = "a cloth, of 3; parts";
  options.date = "19991231.235959";
  const IgesReading reading = read_iges(iges_bytes(plain_weave(yarn::EndStyle::patch), options));
  ASSERT_TRUE(reading.model) << reading.text();
  EXPECT_EQ(reading.model->title, options.title);
  EXPECT_EQ(reading.model->date, options.date);
  EXPECT_EQ(reading.model->units, Unit::inch);
  EXPECT_GT(reading.model->resolution, 0);
}

}  // namespace

}  // namespace selvage::test
