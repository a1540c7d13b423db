// The reader: our own files bit for bit, and texts made by hand whose meaning is known.
#include "formats/iges/reader.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>

#include "core/number_text.h"
#include "formats/iges/bodies.h"
#include "formats/iges/files.h"
#include "formats/iges/reading.h"
#include "shapes.h"

namespace selvage::test {

namespace {

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

cad::Model model_of(const IgesText& text) {
  IgesReading reading = read_iges(text.bytes());
  EXPECT_TRUE(reading.model) << reading.text();
  return reading.model ? std::move(*reading.model) : cad::Model{};
}

IgesText one_face() {
  IgesText text;
  text.add({.type = 128, .parameters = bilinear(1, 2, 3)});
  return text;
}

std::string global_with(double scale, int flag, const std::string& name) {
  return fmt::format(
      "1H,,1H;,4HPart,8Hpart.igs,4HTest,4HTest,32,38,6,308,15,4HPart,{},{},{}H{},1,0.1,"
      "15H20240102.030405,1.E-06,100.,,,11,0,,;",
      scale, flag, name.size(), name);
}

TEST(IgesReader, Units) {
  struct Case {
    int flag;
    const char* name;
    Unit unit;
    double factor;
  };
  // NIST: 1 in = 25.4 mm, 1 ft = 304.8 mm, 1 mi = 1609.344 m.
  for (const Case& c :
       {Case{1, "INCH", Unit::inch, 1}, Case{2, "MM", Unit::mm, 1}, Case{4, "FT", Unit::mm, 304.8},
        Case{5, "MI", Unit::mm, 1609344}, Case{6, "M", Unit::m, 1}, Case{7, "KM", Unit::mm, 1e6},
        Case{8, "MIL", Unit::mm, 0.0254}, Case{9, "UM", Unit::um, 1}, Case{10, "CM", Unit::cm, 1},
        Case{11, "UIN", Unit::mm, 25.4e-6}, Case{3, "FT", Unit::mm, 304.8}, Case{3, "IN", Unit::inch, 1},
        Case{3, "cm", Unit::cm, 1}}) {
    IgesText text = one_face();
    text.global = global_with(1, c.flag, c.name);
    const IgesReading reading = read_iges(text.bytes());
    ASSERT_TRUE(reading.model) << reading.text();
    EXPECT_EQ(reading.model->units, c.unit);
    EXPECT_DOUBLE_EQ(reading.model->parts.at(0).faces.at(0).surface.points[0].z(), 3 * c.factor) << c.name;
    EXPECT_DOUBLE_EQ(reading.model->resolution, 1e-6 * c.factor);
    EXPECT_EQ(reading.says(Severity::note, "turned into mm"), c.factor != 1);
    EXPECT_FALSE(reading.says(Severity::warning, ""));
  }
}

TEST(IgesReader, ModelSpaceScale) {
  IgesText text = one_face();
  text.global = global_with(0.125, 2, "MM");  // one eighth of true size
  const IgesReading reading = read_iges(text.bytes());
  ASSERT_TRUE(reading.model) << reading.text();
  EXPECT_EQ(reading.model->parts.at(0).faces.at(0).surface.points[0], Vec3(8, 16, 24));
  EXPECT_TRUE(reading.says(Severity::note, "true size"));
}

TEST(IgesReader, DefaultedGlobals) {
  IgesText text = one_face();
  text.global = ",,;";
  const cad::Model model = model_of(text);
  EXPECT_EQ(model.units, Unit::inch);  // the standard's defaults
  EXPECT_EQ(model.date, "");
  EXPECT_EQ(model.resolution, 0);
}

TEST(IgesReader, OldDates) {
  IgesText text = one_face();
  text.global = "1H,,1H;,1HA,1HB,,,32,38,6,308,15,,1.,2,2HMM,1,0.1,13H960102.030405,1.E-06,100.;";
  EXPECT_EQ(model_of(text).date, "19960102.030405");
  EXPECT_EQ(model_of(text).title, "A");
}

// The same file with other delimiters, one of which stands in strings.
TEST(IgesReader, AnyDelimitersAndStringsWithDelimiters) {
  IgesText text;
  text.global =
      "1H//1H#/9HPa,rt/#;!/8Hpart.igs/4HTest/4HTest/32/38/6/308/15/4HPart/1./2/2HMM/1/0.1/"
      "15H20240102.030405/1.E-06/100./5HHugo#/3H///#";
  text.parameter_delimiter = '/';
  text.record_delimiter = '#';
  const int name = text.add({.type = 406, .form = 15, .parameters = "1/7Ha/b#,c;"});
  std::string parameters = bilinear(1, 2, 3);
  std::replace(parameters.begin(), parameters.end(), ',', '/');
  text.add({.type = 128, .parameters = parameters + fmt::format("/0/1/{}", name)});
  const IgesReading reading = read_iges(text.bytes());
  ASSERT_TRUE(reading.model) << reading.text();
  EXPECT_EQ(reading.text(), "");
  EXPECT_EQ(reading.model->title, "Pa,rt/#;!");
  EXPECT_EQ(reading.model->parts.at(0).name, "a/b#,c;");
  EXPECT_EQ(reading.model->parts.at(0).faces.at(0).surface.points[3], Vec3(2, 3, 3));
}

// A string over three lines, with blanks at line ends that belong to it.
TEST(IgesReader, LongStrings) {
  std::string name;
  for (int i = 0; i < 30; ++i) name += fmt::format("part {} ", i);
  name += "end";
  IgesText text;
  const int property =
      text.add({.type = 406, .form = 15, .parameters = fmt::format("1,{}H{}", name.size(), name)});
  text.add({.type = 128, .parameters = bilinear(0, 0, 0) + fmt::format(",0,1,{}", property)});
  EXPECT_EQ(model_of(text).parts.at(0).name, name);
}

// A count that runs over the end of its line, and one that is wrong without a doubt.
TEST(IgesReader, CountsOfStrings) {
  IgesText text = one_face();
  text.global = "1H,,1H;,1HA,7Ha.igs/b,,,32,38,6,308,15,,1.,2,2HMM,1,0.1,13H960102.030405,1.E-06,100.;";
  const auto with_second_line_from = [&](const std::string& first, const std::string& rest) {
    std::string bytes = text.bytes();
    const std::size_t line = bytes.find("1H,,1H;,");
    bytes.replace(line, 72, first + std::string(72 - first.size(), ' '));
    bytes.replace(bytes.find('\n', line) + 1, 72, rest + std::string(72 - rest.size(), ' '));
    return read_iges(bytes);
  };
  const std::string rest = ",,,32,38,6,308,15,,1.,2,2HMM,1,0.1,13H960102.030405,1.E-06,100.;";

  const std::string title(57, 'x');
  IgesReading reading =
      with_second_line_from("1H,,1H;,57H" + title + ",,,1", "5HTest 2.0 of 2026,32,38,6,308,15,,1.,2;");
  EXPECT_FALSE(reading.model);  // 15 characters of 16: no string, so its count is none either
  reading = with_second_line_from("1H,,1H;,57H" + title + ",,,1", "6HTest 2.0 of 2026,32,38,6,308,15,,1.,2;");
  ASSERT_TRUE(reading.model) << reading.text();
  EXPECT_EQ(reading.model->title, title);
  EXPECT_EQ(reading.model->units, Unit::mm);

  reading = with_second_line_from("1H,,1H;,1HA,", "99H7 characters,");
  EXPECT_FALSE(reading.model);
  reading = with_second_line_from("1H,,1H;,5HA,", rest.substr(1));
  EXPECT_FALSE(reading.model);  // ",  32" would be characters, too
  reading = with_second_line_from("1H,,1H;,74HA,", rest);
  ASSERT_TRUE(reading.model) << reading.text();
  EXPECT_TRUE(reading.says(Severity::warning, "a string of 1 characters says that it has 74"))
      << reading.text();
  EXPECT_EQ(reading.model->title, "A");
  EXPECT_EQ(reading.model->date, "19960102.030405");
}

TEST(IgesReader, NumbersInEveryForm) {
  IgesText text;
  // Integers where reals stand, reals where integers stand, D exponents, blanks, defaults.
  text.add({.type = 128,
            .parameters = "1.,+1,1,1.0,0,0,1,0,0,0,0,1,1.D0,0.,0.,1.,10.E-1,1,1.,1.,1., "
                          ",,, 1.5D+1,0.,0.,0,.5d0,0.,15,-.5,+2.E-1"});
  const cad::Model model = model_of(text);
  const nurbs::Surface& surface = model.parts.at(0).faces.at(0).surface;
  EXPECT_EQ(surface.points[0], Vec3(0, 0, 0));
  EXPECT_EQ(surface.points[1], Vec3(15, 0, 0));
  EXPECT_EQ(surface.points[2], Vec3(0, 0.5, 0));
  EXPECT_EQ(surface.points[3], Vec3(15, -0.5, 0.2));
  EXPECT_EQ(surface.last_u(), 1);
  EXPECT_TRUE(surface.weights.empty());
}

// p -> R (Q p + q) + r: first the inner matrix, then that of its own directory entry.
TEST(IgesReader, NestedTransformations) {
  IgesText text;
  const int outer =
      text.add({.type = 124, .parameters = "0,-1,0,100,1,0,0,0,0,0,1,0"});  // a quarter turn, then +100 x
  const int inner = text.add({.type = 124, .parameters = "1,0,0,0,0,1,0,0,0,0,1,7", .transformation = outer});
  text.add({.type = 128, .parameters = bilinear(1, 2, 3), .transformation = inner});
  text.add({.type = 126,
            .parameters = "1,1,0,0,1,0,0.,0.,1.,1.,1.,1.,1.,2.,3.,4.,5.,6.,0.,1.,0.,0.,0.",
            .transformation = inner});
  const cad::Model model = model_of(text);
  EXPECT_EQ(model.parts.at(0).faces.at(0).surface.points[0], Vec3(98, 1, 10));
  EXPECT_EQ(model.parts.at(0).faces.at(0).surface.points[1], Vec3(98, 2, 10));
  EXPECT_EQ(model.curves.at(0).curve.points[1], Vec3(95, 4, 13));
}

TEST(IgesReader, ColoursLevelsAndLabels) {
  IgesText text;
  const int color = text.add({.type = 314, .parameters = "100.,50.,0.,6Horange", .status = "00000200"});
  const int levels = text.add({.type = 406, .form = 1, .parameters = "2,17,18"});
  text.add({.type = 406, .form = 3, .parameters = "2,0,6Hwefts ", .level = 17});
  text.add({.type = 128, .parameters = bilinear(0, 0, 0), .color = 1, .level = 4, .label = "BLACK"});
  text.add({.type = 128, .parameters = bilinear(0, 0, 0), .color = 7, .label = "CYAN"});
  text.add({.type = 128, .parameters = bilinear(0, 0, 0), .color = -color, .level = -levels});
  text.add({.type = 128, .parameters = bilinear(0, 0, 0)});
  const cad::Model model = model_of(text);
  ASSERT_EQ(model.parts.size(), 4U);
  EXPECT_EQ(model.parts[0].color, (cad::Color{0, 0, 0}));
  EXPECT_EQ(model.parts[0].level, 4);
  EXPECT_EQ(model.parts[0].name, "BLACK");
  EXPECT_EQ(model.parts[1].color, (cad::Color{0, 255, 255}));
  EXPECT_EQ(model.parts[2].color, (cad::Color{255, 128, 0}));
  EXPECT_EQ(model.parts[2].level, 17);
  EXPECT_EQ(model.parts[3].color, std::nullopt);
  EXPECT_EQ(model.levels.at(17), "wefts");
}

TEST(IgesReader, Groups) {
  for (const int form : {1, 7, 14, 15}) {
    IgesText text;
    std::vector<int> faces;
    for (int i = 0; i < 5; ++i) faces.push_back(text.add({.type = 128, .parameters = bilinear(i, 0, 0)}));
    const int curve =
        text.add({.type = 126,
                  .parameters = "1,1,0,0,1,0,0.,0.,1.,1.,1.,1.,1.,2.,3.,4.,5.,6.,0.,1.,0.,0.,0.",
                  .label = "edge"});
    const int first = text.add({.type = 402,
                                .form = form,
                                .parameters = fmt::format("2,{},{}", faces[1], faces[0]),
                                .label = "ply1"});
    const int second =
        text.add({.type = 402, .form = form, .parameters = fmt::format("1,{}", faces[2]), .label = "ply2"});
    const int yarn = text.add(
        {.type = 402, .form = form, .parameters = fmt::format("2,{},{}", first, second), .label = "yarn"});
    text.add({.type = 402,
              .form = form,
              .parameters = fmt::format("3,{},{},{}", yarn, faces[3], curve),
              .label = "cloth"});
    const cad::Model model = model_of(text);
    ASSERT_EQ(model.parts.size(), 4U);
    EXPECT_EQ(model.parts[0].name, "");  // faces[4], which no group holds
    EXPECT_EQ(model.parts[0].group, "");
    EXPECT_EQ(model.parts[1].name, "ply1");
    EXPECT_EQ(model.parts[1].group, "cloth");
    EXPECT_EQ(model.parts[1].faces.size(), 2U);
    EXPECT_EQ(model.parts[1].faces[0].surface.points[0], Vec3(1, 0, 0));  // in the group's order
    EXPECT_EQ(model.parts[2].name, "ply2");
    EXPECT_EQ(model.parts[2].group, "cloth");
    EXPECT_EQ(model.parts[3].group, "cloth");
    ASSERT_EQ(model.curves.size(), 1U);
    EXPECT_EQ(model.curves[0].name, "edge");
    EXPECT_EQ(model.entities.at("402"), 4U);
  }
}

TEST(IgesReader, WhatDoesNotStandForItself) {
  IgesText text;
  const std::string line = "1,1,0,0,1,0,0.,0.,1.,1.,1.,1.,1.,2.,3.,4.,5.,6.,0.,1.,0.,0.,0.";
  text.add({.type = 126, .parameters = line, .status = "00010000"});  // physically dependent
  text.add({.type = 126, .parameters = line, .status = "00000500"});  // in parameters
  text.add(
      {.type = 128, .parameters = bilinear(0, 0, 0), .status = "00020000"});  // logically dependent: stands
  text.add({.type = 128, .parameters = bilinear(0, 0, 0), .status = "01000000"});  // blanked
  text.add({.type = 212, .parameters = "1,2,3"});
  text.add({.type = 777, .form = 2, .parameters = "1,2,3"});
  const IgesReading reading = read_iges(text.bytes());
  ASSERT_TRUE(reading.model) << reading.text();
  EXPECT_TRUE(reading.model->curves.empty());
  EXPECT_EQ(reading.model->parts.size(), 2U);
  EXPECT_TRUE(reading.says(Severity::note, "blanked"));
  EXPECT_EQ(reading.model->entities.at("126"), 2U);
  EXPECT_EQ(reading.model->unknown.at("212 (general note)"), 1U);
  EXPECT_EQ(reading.model->unknown.at("777 form 2 (no type of IGES 5.3)"), 1U);
}

// Marked as parts of others that are nowhere.
TEST(IgesReader, WhatNobodyRefersToStands) {
  IgesText text;
  const std::string line = "1,1,0,0,1,0,0.,0.,1.,1.,1.,1.,1.,2.,3.,4.,5.,6.,0.,1.,0.,0.,0.";
  text.add({.type = 128, .parameters = bilinear(0, 0, 0), .status = "00010000"});  // D1
  text.add({.type = 126, .parameters = line, .status = "00010000"});               // D3
  text.add({.type = 126, .parameters = line, .status = "00010000"});               // D5, part of D7
  text.add({.type = 102, .parameters = "1,5", .status = "00010000"});
  const IgesReading reading = read_iges(text.bytes());
  ASSERT_TRUE(reading.model) << reading.text();
  EXPECT_EQ(reading.model->parts.size(), 1U);
  ASSERT_EQ(reading.model->curves.size(), 2U) << reading.model->curves.back().origin.entity;
  EXPECT_EQ(reading.model->curves[0].origin.entity, "102 at D7");  // what is made of others comes first
  EXPECT_EQ(reading.model->curves[1].origin.entity, "126 at D3");
}

// An edge runs from its first vertex to its second, whichever way its curve does.
TEST(IgesReader, VerticesTellTheDirectionOfEdges) {
  IgesText text;
  const int surface = text.add({.type = 128, .parameters = bilinear(0, 0, 0), .status = "00010000"});
  const std::array<const char*, 4> lines = {"0.,0.,0.,1.,0.,0.", "1.,1.,0.,1.,0.,0.", "1.,1.,0.,0.,1.,0.",
                                            "0.,0.,0.,0.,1.,0."};  // the second and the last run backwards
  std::vector<int> curves;
  for (const char* line : lines)
    curves.push_back(text.add({.type = 110, .parameters = line, .status = "00010000"}));
  const int vertices = text.add(
      {.type = 502, .form = 1, .parameters = "4,0.,0.,0.,1.,0.,0.,1.,1.,0.,0.,1.,0.", .status = "00010000"});
  std::string edges = "4";
  for (int k = 0; k < 4; ++k)
    edges += fmt::format(",{},{},{},{},{}", curves[static_cast<std::size_t>(k)], vertices, k + 1, vertices,
                         (k + 1) % 4 + 1);
  const int list = text.add({.type = 504, .form = 1, .parameters = edges, .status = "00010000"});
  std::string uses = "4";
  for (int k = 1; k <= 4; ++k) uses += fmt::format(",0,{},{},1,0", list, k);
  const int loop = text.add({.type = 508, .form = 1, .parameters = uses, .status = "00010000"});
  text.add({.type = 510, .form = 1, .parameters = fmt::format("{},1,1,{}", surface, loop)});
  const IgesReading reading = read_iges(text.bytes());
  ASSERT_TRUE(reading.model) << reading.text();
  const cad::Face& face = reading.model->parts.at(0).faces.at(0);
  ASSERT_EQ(face.border.size(), 1U);
  const std::vector<cad::Edge>& round = face.border[0].edges;
  ASSERT_EQ(round.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_EQ(round[k].curve.points.back(), round[(k + 1) % 4].curve.points.front()) << k;
}

// Two parabolas, their common knot once too often.
TEST(IgesReader, TornKnots) {
  const auto curve = [](double start) {
    IgesText text;
    text.add({.type = 126,
              .parameters =
                  "5,2,0,0,1,0,0.,0.,0.,1.,1.,1.,2.,2.,2.,1.,1.,1.,1.,1.,1.,0.,0.,0.,1.,2.,0.,2.,0.,0.," +
                  std::to_string(start) + ",0.,0.,3.,-2.,0.,4.,0.,0.,0.,2.,0.,0.,1."});
    return read_iges(text.bytes());
  };
  const IgesReading joined = curve(2);
  ASSERT_TRUE(joined.model) << joined.text();
  const nurbs::Curve& spline = joined.model->curves.at(0).curve;
  EXPECT_EQ(spline.points.size(), 5U);
  EXPECT_EQ(spline.knots, (std::vector<double>{0, 0, 0, 1, 1, 2, 2, 2}));
  EXPECT_EQ(nurbs::evaluate(spline, 0.5), Vec3(1, 1, 0));
  EXPECT_EQ(nurbs::evaluate(spline, 1.5), Vec3(3, -1, 0));
  EXPECT_TRUE(curve(2.003).says(Severity::warning, "torn at the knot 1, by 0.003"));
  EXPECT_TRUE(curve(2.5).says(Severity::error, "falls apart there, by 0.5"));
}

// One patch x = s, y = t, with the row and the column that mean nothing, and with a name behind them.
TEST(IgesReader, SplineSurfaceHasARowAndAColumnMore) {
  // The sixteen coefficients of a coordinate, of which one is 1 or none.
  const auto coefficients = [](int one) {
    std::string values;
    for (int i = 0; i < 16; ++i) values += i == one ? "1.," : "0.,";
    return values;
  };
  std::string parameters = "3,1,1,1,0.,1.,0.,1.," + coefficients(1) + coefficients(4) + coefficients(-1);
  for (int i = 0; i < 3 * 3; ++i) parameters += coefficients(-1);
  IgesText text;
  text.add({.type = 406, .form = 15, .parameters = "1,4Hwing"});
  text.add({.type = 114, .parameters = parameters + "0,1,1"});
  const IgesReading reading = read_iges(text.bytes());
  ASSERT_TRUE(reading.model) << reading.text();
  ASSERT_EQ(reading.model->parts.size(), 1U);
  EXPECT_EQ(reading.model->parts[0].name, "wing");
  const nurbs::Surface& surface = reading.model->parts[0].faces.at(0).surface;
  EXPECT_LT((nurbs::evaluate(surface, 0.25, 0.75) - Vec3(0.25, 0.75, 0)).norm(), 1e-14);
}

// Knots that are not clamped: a uniform cubic, whose ends are (1 4 1) / 6 of its points.
TEST(IgesReader, PeriodicCurve) {
  IgesText text;
  text.add({.type = 126,
            .parameters = "4,3,1,0,1,1,-3.,-2.,-1.,0.,1.,2.,3.,4.,5.,1.,1.,1.,1.,1.,"
                          "0.,0.,0.,6.,0.,0.,6.,6.,0.,0.,6.,0.,0.,0.,0.,0.,2.,0.,0.,1."});
  const nurbs::Curve curve = model_of(text).curves.at(0).curve;
  EXPECT_EQ(curve.first_parameter(), 0);
  EXPECT_EQ(curve.last_parameter(), 2);
  EXPECT_EQ(curve.knots.front(), -3);
  EXPECT_NEAR((nurbs::evaluate(curve, 0) - Vec3(5, 1, 0)).norm(), 0, 1e-14);
}

// A range narrower than the knots: the same points at the same parameters, of any knots, rational too.
TEST(IgesReader, RestrictedRanges) {
  const std::string knots = "-3.,-2.,-1.,0.,1.,1.5,3.,4.,5.,6.";
  const std::string points = "0.,0.,1.,6.,0.,0.,6.,6.,2.,0.,6.,0.,0.,0.,-1.,3.,1.,0.";
  for (const char* weights : {"1.,1.,1.,1.,1.,1.", "1.,2.,0.5,1.,3.,1."}) {
    IgesText text;
    const auto curve = [&](const char* range) {
      return fmt::format("5,3,0,0,0,0,{},{},{},{},0.,0.,1.", knots, weights, points, range);
    };
    text.add({.type = 126, .parameters = curve("0.,3.")});
    text.add({.type = 126, .parameters = curve("0.25,2.")});
    text.add({.type = 126, .parameters = curve("1.5,3.")});
    const cad::Model model = model_of(text);
    ASSERT_EQ(model.curves.size(), 3U);
    const nurbs::Curve& whole = model.curves[0].curve;
    EXPECT_EQ(whole.knots.size(), 10U);
    for (const std::size_t i : {1U, 2U}) {
      const nurbs::Curve& part = model.curves[i].curve;
      EXPECT_EQ(part.first_parameter(), i == 1 ? 0.25 : 1.5);
      EXPECT_EQ(part.last_parameter(), i == 1 ? 2 : 3);
      for (int k = 0; k <= 20; ++k) {
        const double t = part.first_parameter() + k * (part.last_parameter() - part.first_parameter()) / 20;
        EXPECT_NEAR((nurbs::evaluate(whole, t) - nurbs::evaluate(part, t)).norm(), 0, 1e-13);
      }
    }
  }
}

TEST(IgesReader, RestrictedSurface) {
  Wave shape;
  shape.weight_step = 0.5;
  nurbs::Surface surface = wave("a", shape, yarn::EndStyle::none).surface;
  const auto row = [](const std::vector<double>& values) {
    std::string text;
    for (const double value : values) text += number_text(value) + ",";
    return text;
  };
  std::string parameters = fmt::format("{},{},{},{},0,0,0,0,0,", surface.count_u - 1, surface.count_v - 1,
                                       surface.degree_u, surface.degree_v) +
                           row(surface.knots_u) + row(surface.knots_v) + row(surface.weights);
  for (const Vec3& p : surface.points) parameters += row({p.x(), p.y(), p.z()});
  const double u0 = 0.3 * surface.last_u(), u1 = 0.77 * surface.last_u(), v0 = surface.first_v(),
               v1 = 0.4 * surface.last_v();
  IgesText text;
  text.add({.type = 128, .parameters = parameters + fmt::format("{},{},{},{}", u0, u1, v0, v1)});
  const nurbs::Surface part = model_of(text).parts.at(0).faces.at(0).surface;
  EXPECT_EQ(part.first_u(), u0);
  EXPECT_EQ(part.last_v(), v1);
  EXPECT_LT(part.points.size(), surface.points.size());
  for (int i = 0; i <= 10; ++i)
    for (int j = 0; j <= 10; ++j) {
      const double u = u0 + i * (u1 - u0) / 10, v = v0 + j * (v1 - v0) / 10;
      EXPECT_NEAR((nurbs::evaluate(surface, u, v) - nurbs::evaluate(part, u, v)).norm(), 0, 1e-13);
    }
}

TEST(IgesReader, RangesThatCannotBe) {
  IgesText text;
  std::string parameters = bilinear(0, 0, 0);
  parameters.replace(parameters.size() - 11, 11, "0.,2.,0.,1.");
  text.add({.type = 128, .parameters = parameters});
  const IgesReading reading = read_iges(text.bytes());
  ASSERT_TRUE(reading.model) << reading.text();
  EXPECT_TRUE(reading.says(Severity::warning, "is not within the knots")) << reading.text();
  EXPECT_EQ(reading.model->parts.at(0).faces.at(0).surface.last_u(), 1);
}

// What is written once is written again to the byte.
TEST(IgesReader, DateIsKeptByTheWriter) {
  formats::SurfaceOptions options = surfaces();
  options.date = "20010203.040506";
  options.title = "cloth";
  const std::string bytes = iges_bytes(plain_weave(yarn::EndStyle::fan), options);
  EXPECT_NE(bytes.find("15H20010203.040506"), std::string::npos);
  EXPECT_EQ(read_iges(bytes).model.value().date, options.date);
}

}  // namespace

}  // namespace selvage::test
