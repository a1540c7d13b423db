// The entities beyond B-splines, from texts made by hand, and geometry of CAD files there and back.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cad/from_body.h"
#include "cad/sampled_curve.h"
#include "formats/iges/bodies.h"
#include "formats/iges/files.h"
#include "formats/iges/reading.h"
#include "formats/registry.h"
#include "nurbs/measure.h"
#include "places.h"

namespace selvage::test {

namespace {

using std::numbers::pi;

constexpr const char* dependent = "00010000";

double length_of(const IgesText& file) {
  const IgesReading reading = read_iges(file.bytes());
  EXPECT_TRUE(reading.model) << reading.text();
  if (!reading.model || reading.model->curves.size() != 1) {
    ADD_FAILURE() << "curves: " << (reading.model ? reading.model->curves.size() : 0) << "\n"
                  << reading.text();
    return 0;
  }
  return nurbs::arc_length(reading.model->curves.front().curve);
}

double length_of(int type, int form, const std::string& parameters) {
  IgesText file;
  file.add({.type = type, .form = form, .parameters = parameters});
  return length_of(file);
}

TEST(IgesCurves, Lengths) {
  EXPECT_NEAR(length_of(100, 0, "1.,0.,0.,2.,0.,0.,2."), pi, 1e-12);
  EXPECT_NEAR(length_of(100, 0, "1.,0.,0.,2.,0.,2.,0."), 4 * pi, 1e-12);
  EXPECT_NEAR(length_of(110, 0, "0.,0.,0.,3.,4.,12."), 13, 1e-12);
  EXPECT_NEAR(length_of(106, 11, "1,3,5.,0.,0.,3.,4.,3.,5."), 6, 1e-12);
  // y = x^2 / 4 from -2 to 2.
  EXPECT_NEAR(length_of(104, 3, "1.,0.,0.,0.,-4.,0.,0.,-2.,1.,2.,1."), 2 * (std::sqrt(2.0) + std::asinh(1.0)),
              1e-11);
}

TEST(IgesCurves, PointsAreCountedAndNoGeometry) {
  IgesText file;
  file.add({.type = 116, .parameters = "1.,2.,3.,0"});
  file.add({.type = 106, .form = 2, .parameters = "2,2,0.,0.,0.,1.,1.,1."});
  file.add({.type = 110, .parameters = "0.,0.,0.,1.,0.,0."});
  const IgesReading reading = read_iges(file.bytes());
  ASSERT_TRUE(reading.model) << reading.text();
  EXPECT_EQ(reading.text(), "");
  EXPECT_EQ(reading.model->entities.at("116"), 1U);
  EXPECT_EQ(reading.model->curves.size(), 1U);
  EXPECT_TRUE(reading.model->unknown.empty());
}

// One wrong entity beside a line that is right.
void expect_said(const std::vector<IgesEntity>& entities, Severity severity, const std::string& words) {
  SCOPED_TRACE(words);
  IgesText file;
  for (const IgesEntity& entity : entities) file.add(entity);
  file.add({.type = 110, .parameters = "0.,0.,0.,1.,0.,0."});
  const IgesReading reading = read_iges(file.bytes());
  EXPECT_TRUE(reading.says(severity, words)) << reading.text();
  EXPECT_EQ(reading.model.has_value(), severity != Severity::error);
  if (reading.model) {
    EXPECT_EQ(reading.model->curves.size(), 1U);
  }
}

TEST(IgesEntities, BadInput) {
  const auto error = [](std::vector<IgesEntity> entities, const std::string& words) {
    expect_said(entities, Severity::error, words);
  };
  const auto warning = [](std::vector<IgesEntity> entities, const std::string& words) {
    expect_said(entities, Severity::warning, words);
  };
  const IgesEntity line{.type = 110, .parameters = "0.,0.,0.,0.,0.,1.", .status = dependent};
  const IgesEntity point{.type = 116, .parameters = "0.,0.,0.,0", .status = dependent};
  const IgesEntity up{.type = 123, .parameters = "0.,0.,1.", .status = dependent};
  error({{.type = 100, .parameters = "0.,1.,1.,1.,1.,1.,1."}}, "an arc of radius 0");
  error({{.type = 100, .parameters = "0.,0.,0.,1.,0.,0.,1.5"}}, "its ends are 1 and 1.5 from its centre");
  error({{.type = 102, .parameters = "1,1"}}, "part of itself");
  error({{.type = 102, .parameters = "1,3"}, {.type = 102, .parameters = "1,1"}}, "part of itself");
  error({{.type = 102, .parameters = "0"}}, "it has no curves");
  error({{.type = 102, .parameters = "99999,1"}}, "more than");
  error({{.type = 102, .parameters = "1,3"}, point}, "it has no curves");
  error({{.type = 104, .form = 1, .parameters = "0.,0.,0.,1.,1.,0.,0.,0.,0.,1.,-1."}}, "all zero");
  error({{.type = 106, .form = 12, .parameters = "2,1000000000,0.,0.,0."}}, "more than");
  error({{.type = 106, .form = 12, .parameters = "7,1,0.,0.,0."}}, "no points of kind 7");
  error({{.type = 112, .parameters = "3,2,3,1000000,0.,1."}}, "more than");
  error({{.type = 114, .parameters = "3,1,1000000000,1000000000,0.,1."}}, "more than");
  error({{.type = 118, .form = 1, .parameters = "3,3,0,0"}, up}, "a curve is due, not D3, a 123");
  error({{.type = 118, .form = 1, .parameters = "1,1,0,0"}}, "");
  error({{.type = 120, .parameters = "3,3,1.,1."}, line}, "by nothing");
  error({{.type = 120, .parameters = "3,3,0.,1."},
         {.type = 110, .parameters = "0.,0.,0.,0.,0.,0.", .status = dependent}},
        "its axis is no line");
  error({{.type = 122, .parameters = "3,0.,0.,0."}, line}, "it has no height");
  error({{.type = 122, .parameters = "77,0.,0.,0."}}, "no entity begins at line 77");
  warning({{.type = 108, .parameters = "0.,0.,1.,0.,0,0.,0.,0.,0."}}, "a plane without end");
  error({{.type = 108, .form = 1, .parameters = "0.,0.,0.,0.,3,0.,0.,0.,0."}, line},
        "a plane without a normal");
  warning({{.type = 192, .parameters = "3,5,1."}, point, up}, "it has no end");
  error({{.type = 196, .parameters = "3,0."}, point}, "a radius of 0");
  error({{.type = 196, .parameters = "3,1."}, up}, "a 116 (point) is due");
  error({{.type = 198, .parameters = "3,5,4.,-1."}, point, up}, "a minor radius of -1");
  warning({{.type = 198, .parameters = "3,5,1.,2."}, point, up}, "it crosses itself");
  error({{.type = 144, .parameters = "3,1,0,5"},
         {.type = 128, .parameters = bilinear(0, 0, 0), .status = dependent},
         line},
        "a 142 (curve on a parametric surface) is due");
  error({{.type = 144, .parameters = "3,1,0,5"},
         {.type = 128, .parameters = bilinear(0, 0, 0), .status = dependent},
         {.type = 142, .parameters = "0,3,0,0,0", .status = dependent}},
        "neither in space nor in parameters");
  error({{.type = 143, .parameters = "0,1,1,3"},
         {.type = 141, .parameters = "0,0,1,1,5,1,0", .status = dependent},
         line},
        "");
  error({{.type = 408, .parameters = "3,0.,0.,0.,0."},
         {.type = 308, .parameters = "0,1HA,1,5", .status = "00000200"},
         line},
        "at a scale of 0");
  error({{.type = 408, .parameters = "3,0.,0.,0.,1."},
         {.type = 308, .parameters = "0,1HA,1,1", .status = "00000200"}},
        "holds itself");
}

// A file of 60 lines that would be 2^28 surfaces.
TEST(IgesSubfigures, AreCountedBeforeTheyAreMade) {
  IgesText file;
  file.add({.type = 128, .parameters = bilinear(0, 0, 0), .status = dependent});
  file.add({.type = 308, .parameters = "0,1HA,1,1", .status = "00000200"});
  for (int level = 0; level < 28; ++level) {
    const int definition = 2 * static_cast<int>(file.entities.size()) - 1;
    const int a =
        file.add({.type = 408, .parameters = fmt::format("{},0.,0.,0.,1.", definition), .status = dependent});
    const int b =
        file.add({.type = 408, .parameters = fmt::format("{},1.,0.,0.,1.", definition), .status = dependent});
    file.add({.type = 308, .parameters = fmt::format("0,1HA,2,{},{}", a, b), .status = "00000200"});
  }
  file.add({.type = 408,
            .parameters = fmt::format("{},0.,0.,0.,1.", 2 * static_cast<int>(file.entities.size()) - 1)});
  const IgesReading reading = read_iges(file.bytes());
  EXPECT_FALSE(reading.model);
  EXPECT_TRUE(reading.says(Severity::error, "this instance stands for")) << reading.text();
}

// ---- there and back

std::string written(const cad::Model& model) {
  formats::SurfaceOptions options = surfaces(model.units);
  options.file_name = "parts.igs";
  options.date = "20240102.030405";
  auto opened = OutputFile::in_memory();
  OutputFile& file = opened.value();
  auto made = formats::iges::descriptor().open_bodies(file, options);
  formats::BodyWriter* const writer = made.value().get();
  for (const cad::Part& part : model.parts) {
    const Status status = writer->add_part(part);
    EXPECT_TRUE(status.ok()) << to_string(status.error());
  }
  for (const cad::NamedCurve& curve : model.curves) EXPECT_TRUE(writer->add_curve(curve).ok());
  EXPECT_TRUE(writer->finish().ok());
  EXPECT_TRUE(file.commit().ok());
  return file.contents().value();
}

void expect_same(const nurbs::Curve& a, const nurbs::Curve& b) {
  EXPECT_EQ(a.degree, b.degree);
  EXPECT_EQ(a.knots, b.knots);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.weights, b.weights);
}

void expect_same(const cad::Face& a, const cad::Face& b) {
  EXPECT_EQ(a.surface.degree_u, b.surface.degree_u);
  EXPECT_EQ(a.surface.degree_v, b.surface.degree_v);
  EXPECT_EQ(a.surface.knots_u, b.surface.knots_u);
  EXPECT_EQ(a.surface.knots_v, b.surface.knots_v);
  EXPECT_EQ(a.surface.points, b.surface.points);
  EXPECT_EQ(a.surface.weights, b.surface.weights);
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.color, b.color);
  EXPECT_EQ(a.level, b.level);
  ASSERT_EQ(a.loops.size(), b.loops.size());
  for (std::size_t i = 0; i < a.loops.size(); ++i) {
    ASSERT_EQ(a.loops[i].edges.size(), b.loops[i].edges.size());
    for (std::size_t k = 0; k < a.loops[i].edges.size(); ++k) {
      expect_same(a.loops[i].edges[k].curve, b.loops[i].edges[k].curve);
      // Edges of a solid's parallelograms have their curve in the parameters, too, where the file had none.
      const nurbs::Curve &one = a.loops[i].edges[k].flat, &other = b.loops[i].edges[k].flat;
      const nurbs::Curve& curve = a.loops[i].edges[k].curve;
      if (one.points.empty() == other.points.empty() || curve.points.empty()) {
        expect_same(one, other);
        continue;
      }
      const nurbs::Curve& flat = one.points.empty() ? other : one;
      for (const double share : {0.0, 0.3, 1.0})
        EXPECT_LT((cad::at_share(a.surface, flat, share) - cad::at_share(curve, share)).norm(), 1e-12);
    }
  }
}

void expect_same(const cad::Model& a, const cad::Model& b) {
  ASSERT_EQ(a.parts.size(), b.parts.size());
  for (std::size_t i = 0; i < a.parts.size(); ++i) {
    SCOPED_TRACE(a.parts[i].origin.entity);
    EXPECT_EQ(a.parts[i].name, b.parts[i].name);
    EXPECT_EQ(a.parts[i].group, b.parts[i].group);
    EXPECT_EQ(a.parts[i].color, b.parts[i].color);
    EXPECT_EQ(a.parts[i].level, b.parts[i].level);
    ASSERT_EQ(a.parts[i].faces.size(), b.parts[i].faces.size());
    for (std::size_t k = 0; k < a.parts[i].faces.size(); ++k) {
      expect_same(a.parts[i].faces[k], b.parts[i].faces[k]);
      // Only a 186 says which side is out.
      if (a.parts[i].kind == b.parts[i].kind) {
        EXPECT_EQ(a.parts[i].faces[k].reversed, b.parts[i].faces[k].reversed);
      }
    }
  }
  ASSERT_EQ(a.curves.size(), b.curves.size());
  for (std::size_t i = 0; i < a.curves.size(); ++i) {
    expect_same(a.curves[i].curve, b.curves[i].curve);
    EXPECT_EQ(a.curves[i].name, b.curves[i].name);
    EXPECT_EQ(a.curves[i].color, b.curves[i].color);
    EXPECT_EQ(a.curves[i].level, b.curves[i].level);
  }
}

class IgesParts : public testing::TestWithParam<const char*> {};

// Every fixture: what was read comes back bit for bit, and once more.
TEST_P(IgesParts, ThereAndBack) {
  const auto source = Source::open(std::filesystem::path(places::tests()) / "fixtures/iges" / GetParam());
  ASSERT_TRUE(source.ok());
  const IgesReading first = read_iges(std::string(source.value().bytes()));
  ASSERT_TRUE(first.model) << first.text();
  const std::string bytes = written(*first.model);
  const IgesReading second = read_iges(bytes);
  ASSERT_TRUE(second.model) << second.text();
  EXPECT_EQ(second.text(), "");
  expect_same(*first.model, *second.model);
  EXPECT_EQ(written(*second.model), bytes);
}

INSTANTIATE_TEST_SUITE_P(Fixtures, IgesParts,
                         testing::Values("curves.igs", "surfaces.igs", "trimmed.igs", "subfigures.igs",
                                         "groups.igs", "solids.igs"));

// Yarns with planar ends as any other solid: ends and rims are known edges but for the tube's own.
TEST(IgesPart, ASolidWithKnownEdgesIsA186) {
  cad::Model model;
  cad::Part box;
  box.kind = cad::Part::Kind::solid;
  box.name = "disc";
  // Two half discs over one circle, back to back.
  for (const double z : {0.0, 1.0}) {
    cad::Face face;
    face.surface.degree_u = face.surface.degree_v = 1;
    face.surface.count_u = face.surface.count_v = 2;
    face.surface.knots_u = face.surface.knots_v = {0, 0, 1, 1};
    face.surface.points = {{-2, -2, 0}, {2, -2, z}, {-2, 2, z}, {2, 2, 0}};
    face.reversed = z == 0;
    face.name = z == 0 ? "low" : "high";
    face.loops.push_back(
        {{{{.degree = 1, .knots = {0, 0, 1, 1}, .points = {{-1, -1, 0}, {1, 1, 0}}, .weights = {}}, {}, 4},
          {{.degree = 1,
            .knots = {0, 0, 1, 2, 2},
            .points = {{1, 1, 0}, {1, -1, 0}, {-1, -1, 0}},
            .weights = {}},
           {},
           7}}});
    box.faces.push_back(face);
  }
  model.parts.push_back(box);
  const IgesReading reading = read_iges(written(model));
  ASSERT_TRUE(reading.model) << reading.text();
  EXPECT_EQ(reading.text(), "");
  EXPECT_EQ(reading.model->entities.at("186"), 1U);
  ASSERT_EQ(reading.model->parts.size(), 1U);
  EXPECT_EQ(reading.model->parts[0].kind, cad::Part::Kind::solid);
  expect_same(*reading.model, model);
  const std::vector<cad::Face>& faces = reading.model->parts[0].faces;
  EXPECT_EQ(faces[0].loops[0].edges[0].id, faces[1].loops[0].edges[0].id);
  EXPECT_NE(faces[0].loops[0].edges[0].id, faces[0].loops[0].edges[1].id);
}

TEST(IgesPart, WhatCannotBeWritten) {
  cad::Part part;
  part.name = "bad";
  part.faces.emplace_back();
  part.faces[0].surface = cad::part_of(wave("w", {}, yarn::EndStyle::patch)).faces[0].surface;
  part.faces[0].surface.points[3].y() = std::nan("");
  part.origin.place.line = 17;
  auto opened = OutputFile::in_memory();
  OutputFile& file = opened.value();
  auto made = formats::iges::descriptor().open_bodies(file, surfaces());
  formats::BodyWriter* const writer = made.value().get();
  const Status status = writer->add_part(part);
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.error().text.find("part bad has a coordinate, weight or knot that is not a finite number"),
            std::string::npos);
  EXPECT_EQ(status.error().place.line, 17);
}

}  // namespace

}  // namespace selvage::test
