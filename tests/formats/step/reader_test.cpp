// The STEP reader: yarns come back with every bit, names, colours, groups, units; bad files get an error.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fmt/format.h>
#include <filesystem>

#include "bodies.h"
#include "cad/from_body.h"
#include "formats/registry.h"
#include "shapes.h"

namespace selvage {
namespace {

using formats::SurfaceOptions;
using test::expect_same_bits;
using yarn::EndStyle;
namespace fs = std::filesystem;

std::string written_by(const std::function<void(formats::BodyWriter&)>& add,
                       const SurfaceOptions& options = {}) {
  std::string folder = (fs::temp_directory_path() / "selvage-read-XXXXXX").string();
  EXPECT_NE(::mkdtemp(folder.data()), nullptr);
  const fs::path path = fs::path(folder) / "fabric.stp";
  std::string bytes;
  {
    Result<OutputFile> output = OutputFile::create(path);
    EXPECT_TRUE(output.ok());
    auto writer = formats::step::descriptor().open_bodies(*output, options);
    EXPECT_TRUE(writer.ok());
    add(**writer);
    const auto facts = (*writer)->finish();
    EXPECT_TRUE(facts.ok()) << to_string(facts.error());
    EXPECT_TRUE(output->commit().ok());
    Result<Source> source = Source::open(path);
    EXPECT_TRUE(source.ok());
    if (source) bytes = source->bytes();
  }
  fs::remove_all(folder);
  return bytes;
}

std::string written(const std::vector<yarn::Body>& bodies, const SurfaceOptions& options = {}) {
  return written_by(
      [&](formats::BodyWriter& writer) {
        for (const yarn::Body& body : bodies) EXPECT_TRUE(writer.add(body).ok());
      },
      options);
}

struct ModelReading {
  std::optional<cad::Model> model;
  std::vector<Message> messages;
};

ModelReading read(const std::string& bytes) {
  Diagnostics diagnostics;
  ModelReading reading;
  reading.model = formats::step::descriptor().read_model(Source::from_memory(bytes, "a.stp"), diagnostics);
  reading.messages = diagnostics.messages();
  EXPECT_EQ(reading.model.has_value(), !diagnostics.has_errors());
  return reading;
}

cad::Model model_of(const std::string& bytes) {
  ModelReading reading = read(bytes);
  EXPECT_TRUE(reading.model.has_value());
  for (const Message& message : reading.messages) ADD_FAILURE() << to_string(message);
  return reading.model.value_or(cad::Model{});
}

// A trimmed rectangle comes back as a rectangle of its plane, the loops with it.
void expect_same_plane(const cad::Face& face, const cad::Face& own) {
  const std::vector<Vec3>&a = face.surface.points, &b = own.surface.points;
  ASSERT_EQ(a.size(), 4U);
  const Vec3 normal = (b[1] - b[0]).cross(b[2] - b[0]).normalized();
  EXPECT_LT((normal - (a[1] - a[0]).cross(a[2] - a[0]).normalized()).norm(), 1e-12);
  for (const Vec3& p : a) EXPECT_LT(std::abs(normal.dot(p - b[0])), 1e-12);
  for (std::size_t i = 0; i < own.loops.size(); ++i) {
    ASSERT_EQ(face.loops[i].edges.size(), own.loops[i].edges.size());
    for (std::size_t k = 0; k < own.loops[i].edges.size(); ++k)
      EXPECT_EQ(face.loops[i].edges[k].curve.points, own.loops[i].edges[k].curve.points);
  }
}

// `trimmed`: surfaces under loops are the same, too; what is no rectangle to the bit.
void expect_part(const cad::Part& part, const cad::Part& own, bool trimmed) {
  SCOPED_TRACE(own.name);
  EXPECT_EQ(part.kind, own.kind);
  EXPECT_EQ(part.name, own.name);
  EXPECT_EQ(part.group, own.group);
  EXPECT_EQ(part.color, own.color);
  ASSERT_EQ(part.faces.size(), own.faces.size());
  for (std::size_t i = 0; i < own.faces.size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(part.faces[i].loops.size(), own.faces[i].loops.size());
    if (trimmed || own.faces[i].loops.empty()) {
      if (own.faces[i].loops.empty() || own.faces[i].surface.points.size() > 4)
        expect_same_bits(part.faces[i].surface, own.faces[i].surface);
      else
        expect_same_plane(part.faces[i], own.faces[i]);
      EXPECT_EQ(part.faces[i].reversed, own.faces[i].reversed);
    }
    EXPECT_EQ(part.faces[i].color, own.faces[i].color);
    EXPECT_GT(part.faces[i].origin.place.line, 1);
  }
}

void expect_body(const cad::Part& part, const yarn::Body& body) {
  expect_part(part, cad::part_of(body), false);
}

TEST(StepReader, YarnsComeBackWithEveryBit) {
  for (const Unit unit : all_units) {
    SCOPED_TRACE(name_of(unit));
    const double size = 1.0 / millimetres_per(unit);
    std::vector<yarn::Body> bodies;
    for (const EndStyle style : {EndStyle::patch, EndStyle::fan, EndStyle::planar, EndStyle::none})
      for (const double stretch : {1.0, 0.1234567890123, 987.654321})
        bodies.push_back(
            tests::wave(fmt::format("wave_{}_{}", name_of(style), stretch), style, size * stretch));
    bodies.push_back(tests::ring("ring", size, 5 * size));
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      bodies[i].color = {static_cast<int>(i), 255 - static_cast<int>(i), 17};
      if (i > 4 && i < 7) bodies[i].group = "cord";
    }
    SurfaceOptions options;
    options.units = unit;
    options.title = "Thirteen yarns";
    const cad::Model model = model_of(written(bodies, options));
    EXPECT_EQ(model.units, unit);
    EXPECT_EQ(model.title, "Thirteen yarns");
    EXPECT_NEAR(model.resolution * millimetres_per(unit), 1e-7, 1e-16);
    ASSERT_EQ(model.parts.size(), bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) expect_body(model.parts[i], bodies[i]);
    EXPECT_EQ(model.entities.at("MANIFOLD_SOLID_BREP"), 10U);
    EXPECT_TRUE(model.unknown.empty());
    EXPECT_TRUE(model.curves.empty());
  }
}

TEST(StepReader, EveryColorSurvives) {
  std::vector<yarn::Body> bodies;
  for (int i = 0; i < 256; i += 3) {
    bodies.push_back(tests::tube(std::to_string(i), EndStyle::patch, 1.0, {3.0 * i, 0, 0}));
    bodies.back().color = {i, std::min(i + 1, 255), std::min(i + 2, 255)};
  }
  const cad::Model model = model_of(written(bodies));
  ASSERT_EQ(model.parts.size(), bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) EXPECT_EQ(model.parts[i].color, bodies[i].color);
}

std::string written_parts(const std::vector<cad::Part>& parts, const std::vector<cad::NamedCurve>& curves) {
  return written_by([&](formats::BodyWriter& writer) {
    for (const cad::Part& part : parts) {
      const Status added = writer.add_part(part);
      EXPECT_TRUE(added.ok()) << to_string(added.error());
    }
    for (const cad::NamedCurve& curve : curves) EXPECT_TRUE(writer.add_curve(curve).ok());
  });
}

// What is no yarn is written as it stands: solids sewn of untrimmed and trimmed faces, shells, loose faces,
// curves.
TEST(StepReader, ForeignPartsComeBack) {
  std::vector<cad::Part> parts;
  for (const EndStyle style : {EndStyle::patch, EndStyle::fan, EndStyle::planar}) {
    parts.push_back(cad::part_of(tests::wave("wave_" + std::string(name_of(style)), style)));
    parts.back().group = style == EndStyle::planar ? "" : "two";
  }
  parts.push_back(cad::part_of(tests::ring("ring", 1.0, 5.0)));
  parts.push_back(cad::part_of(tests::wave("open", EndStyle::none)));
  parts.push_back(parts[0]);
  parts.back().kind = cad::Part::Kind::surfaces;
  parts.back().name = "loose", parts.back().group = "";
  parts.push_back(parts[0]);
  parts.back().kind = cad::Part::Kind::shell;
  parts.back().name = "shell", parts.back().group = "";
  parts.back().faces.pop_back();
  parts.push_back(parts[0]);
  parts.back().name = "motley", parts.back().group = "";
  parts.back().faces[1].color = cad::Color{1, 2, 3};
  cad::NamedCurve curve;
  curve.name = "line";
  curve.color = cad::Color{4, 5, 6};
  curve.curve = test::line({0, 0, 0}, {1, 2, 3});
  const cad::Model model = model_of(written_parts(parts, {curve}));
  ASSERT_EQ(model.parts.size(), parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) expect_part(model.parts[i], parts[i], true);
  ASSERT_EQ(model.curves.size(), 1U);
  EXPECT_EQ(model.curves[0].name, "line");
  EXPECT_EQ(model.curves[0].color, curve.color);
  EXPECT_EQ(model.curves[0].curve.points, curve.curve.points);
}

// A small file of one yarn, cut short at many places: an error with its line, nothing else.
TEST(StepReader, TruncatedFilesAreErrors) {
  const std::string whole = written({tests::tube("yarn", EndStyle::planar)});
  const std::size_t end = whole.rfind("END-ISO-10303-21;") + std::string_view("END-ISO-10303-21;").size();
  for (std::size_t cut = 0; cut < end; ++cut) {
    const ModelReading reading = read(whole.substr(0, cut));
    ASSERT_FALSE(reading.model.has_value()) << cut;
    ASSERT_EQ(reading.messages.size(), 1U) << cut;
    ASSERT_GT(reading.messages[0].place.line, 0) << cut;
  }
}

// The bytes with the one place of `from` replaced.
std::string with(std::string bytes, const std::string& from, const std::string& to) {
  const std::size_t at = bytes.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  if (at != std::string::npos) bytes.replace(at, from.size(), to);
  return bytes;
}

void expect_error(const std::string& bytes, const std::string& words) {
  const ModelReading reading = read(bytes);
  EXPECT_FALSE(reading.model.has_value()) << words;
  bool found = false;
  for (const Message& message : reading.messages) {
    EXPECT_GT(message.place.line, 0) << message.text;
    found = found || message.text.find(words) != std::string::npos;
  }
  EXPECT_TRUE(found) << words << (reading.messages.empty() ? "" : ": " + to_string(reading.messages[0]));
}

// Faults of programs that leave no doubt about what is meant: each is told once, and the file read as it was.
TEST(StepReader, WhatIsUnambiguousIsReadThrough) {
  const std::string whole = written({tests::tube("yarn 'a b'", EndStyle::planar)});
  const std::size_t at = whole.find("#36 = CARTESIAN_POINT");
  ASSERT_NE(at, std::string::npos);
  const std::string point = whole.substr(at, whole.find(";\n", at) + 2 - at);
  const struct {
    std::string bytes, words;
  } faults[] = {
      {with(whole, "'AP242", "'ccd_cla_cvp_ast AP242"), "of the schema 'ccd_cla_cvp_ast AP242"},
      {with(whole, point, point + point), "#36 is defined a second time, first in line "},
      {with(whole, "FILE_DESCRIPTION((''),",
            "FILE_DESCRIPTION(('l'\xC3\xA9toile, l'\\X2\\00E9\\X0\\toile'),"),
       "an apostrophe inside this string is not doubled"},
      {with(whole, "BREP('yarn ''a b'''", "BREP('yarn 'a b'''"),
       "an apostrophe inside this string is not doubled"},
      {with(whole, "'2;1');", "'2;1')"), "no ';' behind FILE_DESCRIPTION of the header"},
      {with(whole, "SURFACE_STYLE_USAGE(.BOTH.", "SURFACE_STYLE_USAGE($"),
       "attribute 1 of SURFACE_STYLE_USAGE is '$'"},
  };
  const ModelReading before = read(whole);
  ASSERT_TRUE(before.model.has_value());
  for (const auto& [bytes, words] : faults) {
    const ModelReading reading = read(bytes);
    ASSERT_TRUE(reading.model.has_value()) << words;
    std::size_t told = 0;
    for (const Message& message : reading.messages) {
      EXPECT_EQ(message.severity, Severity::warning) << to_string(message);
      if (message.text.find(words) == std::string::npos) continue;
      ++told;
      EXPECT_GT(message.place.line, 0);
    }
    EXPECT_EQ(told, 1U) << words;
    ASSERT_EQ(reading.model->parts.size(), 1U);
    EXPECT_EQ(reading.model->parts[0].name, "yarn 'a b'");
    ASSERT_EQ(reading.model->parts[0].faces.size(), before.model->parts[0].faces.size());
    for (std::size_t i = 0; i < before.model->parts[0].faces.size(); ++i)
      EXPECT_EQ(reading.model->parts[0].faces[i].surface.points,
                before.model->parts[0].faces[i].surface.points);
  }
}

TEST(StepReader, BadFilesAreErrorsWithTheirLine) {
  const std::string whole = written({tests::tube("yarn", EndStyle::planar)});
  expect_error("", "not a STEP file");
  expect_error("ISO-10303-21;\n", "'HEADER;' is missing");
  expect_error(with(whole, "DATA;", "DATA;\n#1 = ORIGIN();"), "#1 is defined a second time");
  expect_error(with(whole, "ADVANCED_FACE('',(", "ADVANCED_FACE('',(#99999,"),
               "refers to #99999, which is not");
  expect_error(with(whole, "(0.,", "(1E999,"), "larger than any number");
  expect_error(with(whole, "PRODUCT('yarn',", "PRODUCT('yarn'x,"),
               "an apostrophe inside it is written twice");
  expect_error(with(whole, "(0.,", "(0.,,"), "where a value should stand");
  expect_error(with(whole, "(0.,", "(@,"), "no part of a STEP file");
  expect_error(with(whole, "DATA;", "DATA; /* no end"), "this comment has no end");
  expect_error(with(whole, "DATA;", "DATA;\n#90000=MAPPED_ITEM('',#90001);#90001=MAPPED_ITEM('',#90000);"),
               "refers to itself");
  expect_error(with(whole, "DATA;", "DATA;\n#0 = ORIGIN();"), "'#' is not followed");
}

TEST(StepReader, WhatIsLostIsTold) {
  const std::string whole = written({tests::tube("yarn", EndStyle::patch)});
  for (const char* type : {"MANIFOLD_SOLID_BREP(", "CLOSED_SHELL("}) {
    std::string bytes = with(whole, type, "NO_SUCH_" + std::string(type));
    const ModelReading reading = read(bytes);
    EXPECT_FALSE(reading.messages.empty()) << type;
  }
}

}  // namespace
}  // namespace selvage
