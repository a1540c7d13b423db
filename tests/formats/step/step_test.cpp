// STEP files through the module, read back by OpenCASCADE's reader: names, colours, units, validity, volumes.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <regex>

#include "bodies.h"
#include "formats/registry.h"
#include "formats/step/options.h"
#include "reading.h"
#include "unit/core/scratch_folder.h"

namespace selvage {
namespace {

using formats::SurfaceOptions;
using formats::WriteFacts;
using yarn::EndStyle;
namespace fs = std::filesystem;

class Step : public ::testing::Test {
 protected:
  std::string path() const { return (folder_ / "fabric.stp").string(); }

  Result<WriteFacts> write(const std::vector<yarn::Body>& bodies, const SurfaceOptions& options = {}) {
    Result<OutputFile> output = OutputFile::create(path());
    if (!output) return output.error();
    auto writer = formats::step::descriptor().open_bodies(*output, options);
    if (!writer) return writer.error();
    for (const yarn::Body& body : bodies) {
      Status added = (*writer)->add(body);
      if (!added.ok()) return added.error();
    }
    Result<WriteFacts> facts = (*writer)->finish();
    if (!facts) return facts;
    Status committed = output->commit();
    if (!committed.ok()) return committed.error();
    return facts;
  }

  std::string text() const {
    Result<Source> source = Source::open(path());
    return source ? std::string(source->bytes()) : std::string();
  }

  const test::ScratchFolder scratch_;
  const fs::path& folder_ = scratch_.path();
};

SurfaceOptions in_unit(Unit unit) {
  SurfaceOptions options;
  options.units = unit;
  return options;
}

void expect_sound(const tests::ReadPart& part, const yarn::Body& body, double millimetres) {
  EXPECT_EQ(part.name, body.name);
  EXPECT_TRUE(part.is_solid) << body.name;
  EXPECT_TRUE(part.valid) << body.name;
  EXPECT_EQ(part.free_edges, 0) << body.name;
  EXPECT_NEAR(part.volume / (body.volume * millimetres * millimetres * millimetres), 1.0, 1e-6) << body.name;
}

TEST_F(Step, EveryEndStyleReadsBackAsValidSolid) {
  std::vector<yarn::Body> bodies;
  for (EndStyle style : {EndStyle::patch, EndStyle::fan, EndStyle::planar}) {
    bodies.push_back(tests::tube("tube_" + std::string(name_of(style)), style));
    bodies.push_back(tests::wave("wave_" + std::string(name_of(style)), style));
  }
  bodies.push_back(tests::ring("ring", 1.0, 5.0));
  for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].color = {static_cast<int>(i), 17, 255};
  SurfaceOptions options;
  options.title = "Seven yarns";
  for (const char* schema : {"AP242", "AP214"}) {
    options.own.set(formats::step::option::schema, schema);
    Result<WriteFacts> facts = write(bodies, options);
    ASSERT_TRUE(facts.ok()) << to_string(facts.error());
    EXPECT_EQ(facts->entities.at("MANIFOLD_SOLID_BREP"), 7U);
    EXPECT_TRUE(facts->messages.empty());
    const tests::ReadFile read = tests::read_step(path());
    ASSERT_TRUE(read.ok);
    EXPECT_EQ(read.title, "Seven yarns");
    ASSERT_EQ(read.parts.size(), bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      expect_sound(read.parts[i], bodies[i], 1.0);
      EXPECT_EQ(read.parts[i].faces, bodies[i].closed_along ? 1 : 3);
      EXPECT_LT(read.parts[i].tolerance, 1e-6) << bodies[i].name;
      EXPECT_EQ(read.parts[i].color,
                (std::array{bodies[i].color.red, bodies[i].color.green, bodies[i].color.blue}));
    }
  }
}

TEST_F(Step, EveryUnitKeepsLengthsAndBits) {
  // A yarn 0.8 mm wide: 8e-4 in metres, 800 in micrometres.
  for (Unit unit : all_units)
    for (EndStyle style : {EndStyle::patch, EndStyle::fan, EndStyle::planar}) {
      const double millimetres = millimetres_per(unit);
      const yarn::Body body = tests::wave("yarn", style, 1.0 / millimetres);
      ASSERT_TRUE(write({body}, in_unit(unit)).ok());
      tests::ReadFile read = tests::read_step(path());
      ASSERT_TRUE(read.ok);
      ASSERT_EQ(read.parts.size(), 1U);
      expect_sound(read.parts[0], body, millimetres);
      EXPECT_LT(read.parts[0].tolerance, 1e-6) << name_of(unit) << " " << name_of(style);
      const Box3 box = yarn::bounds(body);
      EXPECT_LT((read.parts[0].box.max() - box.max() * millimetres).norm(), 1e-12) << name_of(unit);
      EXPECT_LT((read.parts[0].box.min() - box.min() * millimetres).norm(), 1e-12) << name_of(unit);
    }
}

TEST_F(Step, MaterialsAndLayersAreRead) {
  for (Unit unit : all_units) {
    yarn::Body warp = tests::tube("warp", EndStyle::patch),
               weft = tests::tube("weft", EndStyle::fan, 1.0, {3, 0, 0});
    warp.role = yarn::Role::warp;
    warp.material = "E-glass";
    warp.density = 1.875;
    weft.role = yarn::Role::weft;
    ASSERT_TRUE(write({warp, weft}, in_unit(unit)).ok());
    const tests::ReadFile read = tests::read_step(path());
    ASSERT_EQ(read.parts.size(), 2U);
    EXPECT_EQ(read.parts[0].material, "E-glass");
    EXPECT_NEAR(read.parts[0].density, 1.875, 1e-12) << name_of(unit);
    EXPECT_EQ(read.parts[0].layer, "warp");
    EXPECT_EQ(read.parts[1].density, 0);
    EXPECT_EQ(read.parts[1].layer, "weft");
  }
}

TEST_F(Step, FineFibreInMetres) {
  const yarn::Body body = tests::wave("fibre", EndStyle::patch, 1e-5);  // 8 micrometres wide
  ASSERT_TRUE(write({body}, in_unit(Unit::m)).ok());
  const tests::ReadFile read = tests::read_step(path());
  ASSERT_TRUE(read.ok);
  expect_sound(read.parts.at(0), body, 1e3);
}

// The control points of the file's first B-spline surface as its text says them, u fastest. (OpenCASCADE's
// reader makes closed surfaces periodic, which recomputes points.)
std::vector<Vec3> first_surface(const std::string& file) {
  std::map<int, Vec3> points;
  const std::regex point(R"(#(\d+) = CARTESIAN_POINT\('',\(([^,)]*),\s*([^,)]*),\s*([^,)]*)\)\);)");
  for (std::sregex_iterator it(file.begin(), file.end(), point), none; it != none; ++it)
    points[std::stoi((*it)[1])] = {std::stod((*it)[2]), std::stod((*it)[3]), std::stod((*it)[4])};
  const std::size_t at = file.find("B_SPLINE_SURFACE_WITH_KNOTS");
  const std::string list =
      file.substr(at, file.find(".UNSPEC", at) - at);  // ((row of u = 0), (row of u = 1), ..
  std::vector<std::vector<Vec3>> along;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i] == '(') along.emplace_back();
    if (list[i] == '#') along.back().push_back(points.at(std::stoi(list.substr(i + 1))));
  }
  std::erase_if(along, [](const auto& row) { return row.empty(); });
  std::vector<Vec3> result;
  for (std::size_t j = 0; !along.empty() && j < along.front().size(); ++j)
    for (const auto& row : along) result.push_back(row.at(j));
  return result;
}

TEST_F(Step, ControlPointsAreBitIdentical) {
  for (Unit unit : all_units)
    for (double size : {0.1234567890123, 1.0, 1e-7, 98765.4321}) {
      const yarn::Body body = tests::wave("yarn", EndStyle::patch, size);
      ASSERT_TRUE(write({body}, in_unit(unit)).ok());
      EXPECT_EQ(first_surface(text()), body.surface.points) << name_of(unit);
    }
}

TEST_F(Step, OpenEndsBecomeAShellWithAWarning) {
  yarn::Body sleeve = tests::tube("sleeve", EndStyle::none);
  sleeve.color = {1, 2, 3};
  const yarn::Body closed = tests::tube("closed", EndStyle::patch, 1.0, {3, 0, 0});
  Result<WriteFacts> facts = write({sleeve, closed});
  ASSERT_TRUE(facts.ok());
  ASSERT_EQ(facts->messages.size(), 1U);
  EXPECT_EQ(facts->messages[0].severity, Severity::warning);
  EXPECT_EQ(facts->messages[0].yarn, "sleeve");
  EXPECT_EQ(facts->entities.at("SHELL_BASED_SURFACE_MODEL"), 1U);
  const tests::ReadFile read = tests::read_step(path());
  ASSERT_EQ(read.parts.size(), 2U);
  EXPECT_EQ(read.parts[0].name, "sleeve");
  EXPECT_FALSE(read.parts[0].is_solid);
  EXPECT_EQ(read.parts[0].free_edges, 2);
  EXPECT_EQ(read.parts[0].color, (std::array{1, 2, 3}));
  expect_sound(read.parts[1], closed, 1.0);
}

TEST_F(Step, NamesSurvive) {
  std::vector<yarn::Body> bodies;
  for (const char* name :
       {"warp_1", "it's", "back\\slash", "K\xC3\xBCnstler \xE7\xB5\xB9", "two words",
        "a_name_of_more_than_seventy_characters_so_that_it_does_not_fit_into_one_line_of_the_file"})
    bodies.push_back(
        tests::tube(name, EndStyle::patch, 1.0, {3.0 * static_cast<double>(bodies.size()), 0, 0}));
  SurfaceOptions options;
  options.title =
      "Gew\xC3\xB6"
      "be";
  ASSERT_TRUE(write(bodies, options).ok());
  for (const char c : text()) EXPECT_LT(static_cast<unsigned char>(c), 0x80U);
  const tests::ReadFile read = tests::read_step(path());
  ASSERT_EQ(read.parts.size(), bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) EXPECT_EQ(read.parts[i].name, bodies[i].name);
  EXPECT_EQ(read.title, options.title);
}

TEST_F(Step, HeaderSaysWhatWroteIt) {
  SurfaceOptions options;
  options.file_name = "cloth.stp";
  options.title = "Plain weave";
  ::setenv("SOURCE_DATE_EPOCH", "86400", 1);
  ASSERT_TRUE(write({tests::tube("yarn", EndStyle::patch)}, options).ok());
  const std::string first = text();
  EXPECT_TRUE(first.starts_with("ISO-10303-21;\nHEADER;\n"));
  EXPECT_TRUE(first.ends_with("END-ISO-10303-21;\n"));
  EXPECT_NE(first.find("FILE_NAME('cloth.stp','1970-01-02T00:00:00'"), std::string::npos)
      << first.substr(0, 400);
  EXPECT_NE(first.find("'selvage 0.1.0'"), std::string::npos);
  EXPECT_NE(first.find("FILE_DESCRIPTION(('Plain weave')"), std::string::npos);
  EXPECT_NE(first.find("AP242_MANAGED_MODEL_BASED_3D_ENGINEERING"), std::string::npos);
  options.own.set(formats::step::option::schema, "AP214");
  ASSERT_TRUE(write({tests::tube("yarn", EndStyle::patch)}, options).ok());
  EXPECT_NE(text().find("AUTOMOTIVE_DESIGN"), std::string::npos);
  ::unsetenv("SOURCE_DATE_EPOCH");
}

TEST_F(Step, SameInputSameBytes) {
  std::vector<yarn::Body> bodies;
  for (int i = 0; i < 12; ++i) {
    bodies.push_back(tests::tube("yarn" + std::to_string(i), EndStyle::patch, 1.0, {3.0 * i, 0, 0}));
    bodies.back().color = {20 * (i % 3), 1, 2};
  }
  ::setenv("SOURCE_DATE_EPOCH", "86400", 1);
  ASSERT_TRUE(write(bodies).ok());
  const std::string first = text();
  // Other files in between, with other settings, and another order in memory.
  ASSERT_TRUE(write({tests::ring("ring", 1, 5)}, in_unit(Unit::inch)).ok());
  const std::vector<std::vector<char>> holes(100, std::vector<char>(777));
  ASSERT_TRUE(write(bodies).ok());
  EXPECT_EQ(text(), first);
  ::unsetenv("SOURCE_DATE_EPOCH");
}

TEST_F(Step, LinesAreShortAndRealsHaveAPoint) {
  ASSERT_TRUE(write({tests::wave("yarn", EndStyle::patch)}).ok());
  const std::string all = text();
  for (std::size_t from = 0; from < all.size();) {
    const std::size_t end = all.find('\n', from);
    EXPECT_LE(end - from, 80U) << all.substr(from, end - from);
    from = end + 1;
  }
  const std::regex point(R"(CARTESIAN_POINT\(''?,\(([^)]*)\)\))"),
      real(R"(\s*-?[0-9]+\.[0-9]*(E[+-]?[0-9]+)?)");
  int points = 0;
  for (std::sregex_iterator it(all.begin(), all.end(), point), none; it != none; ++it, ++points) {
    std::string numbers = (*it)[1];
    for (std::size_t from = 0; from <= numbers.size();) {
      const std::size_t comma = std::min(numbers.find(',', from), numbers.size());
      EXPECT_TRUE(std::regex_match(numbers.substr(from, comma - from), real)) << numbers;
      from = comma + 1;
    }
  }
  EXPECT_GT(points, 288);
}

TEST_F(Step, UnknownSchemaIsAnError) {
  SurfaceOptions options;
  options.own.set(formats::step::option::schema, "AP203");
  Result<WriteFacts> facts = write({tests::tube("yarn", EndStyle::patch)}, options);
  ASSERT_FALSE(facts.ok());
  EXPECT_EQ(facts.error().kind, Kind::usage);
  EXPECT_NE(facts.error().text.find("AP203"), std::string::npos);
  EXPECT_FALSE(fs::exists(path()));
}

TEST_F(Step, MovedEndIsRefused) {
  yarn::Body body = tests::wave("moved", EndStyle::patch);
  for (Vec3& p : body.start.surface.points) p += 1e-6 * body.start.normal;
  Result<WriteFacts> facts = write({body});
  ASSERT_FALSE(facts.ok());
  EXPECT_EQ(facts.error().kind, Kind::geometry);
  EXPECT_EQ(facts.error().yarn, "moved");
  EXPECT_FALSE(fs::exists(path()));
}

TEST_F(Step, FaceTurnedInsideOutIsRefused) {
  yarn::Body body = tests::wave("turned", EndStyle::patch);
  body.end.inward = !body.end.inward;
  Result<WriteFacts> facts = write({body});
  ASSERT_FALSE(facts.ok());
  EXPECT_EQ(facts.error().yarn, "turned");
}

TEST_F(Step, NumberThatIsNoneIsRefused) {
  yarn::Body body = tests::tube("broken", EndStyle::patch);
  body.surface.points[40].y() = std::numeric_limits<double>::quiet_NaN();
  Result<WriteFacts> facts = write({body});
  ASSERT_FALSE(facts.ok());
  EXPECT_NE(facts.error().text.find("broken"), std::string::npos);
}

TEST_F(Step, NothingToWriteIsAnError) {
  EXPECT_FALSE(write({}).ok());
}

TEST_F(Step, FullDiskIsAnError) {
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  ::getrlimit(RLIMIT_FSIZE, &old);
  const rlimit small{4096, old.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &small);
  Result<WriteFacts> facts = write({tests::wave("yarn", EndStyle::patch)});
  ::setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, before);
  ASSERT_FALSE(facts.ok());
  EXPECT_EQ(facts.error().kind, Kind::io);
  EXPECT_FALSE(fs::exists(path()));
}

TEST_F(Step, DescriptorKnowsItsFiles) {
  const formats::Descriptor& descriptor = formats::step::descriptor();
  EXPECT_EQ(descriptor.name, "step");
  EXPECT_TRUE(descriptor.sniff("ISO-10303-21;\nHEADER;"));
  EXPECT_TRUE(descriptor.sniff("\n ISO-10303-21;"));
  EXPECT_FALSE(descriptor.sniff("fabric 1\n"));
  EXPECT_FALSE(descriptor.sniff(""));
}

}  // namespace
}  // namespace selvage
