// Every kind of file before the independent judge iges_oracle.py: format, pointers, flags, topology, and all
// numbers against the model, to the last bit.
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>

#include "formats/iges/bodies.h"
#include "formats/iges/files.h"

namespace selvage::test {
namespace {

using yarn::EndStyle;

void expect_right(const std::string& name, const std::vector<yarn::Body>& bodies,
                  const formats::SurfaceOptions& options = {}) {
  const auto file = write_iges(name, bodies, options);
  const Output verdict = judge(file, dump_model(name, bodies, options));
  EXPECT_EQ(verdict.exit_code, 0) << verdict.text;
}

class Ends : public testing::TestWithParam<std::tuple<EndStyle, bool>> {};

TEST_P(Ends, PlainWeaveIsRight) {
  const auto [ends, solid] = GetParam();
  std::vector<yarn::Body> bodies = plain_weave(ends);
  formats::SurfaceOptions options = solid ? solids() : surfaces();
  options.title = "Plain weave, 4 yarns";
  if (solid) bodies.resize(1);  // the judge's closest points take their time
  expect_right("weave.igs", bodies, options);
}

INSTANTIATE_TEST_SUITE_P(, Ends,
                         testing::Values(std::tuple(EndStyle::patch, false), std::tuple(EndStyle::fan, false),
                                         std::tuple(EndStyle::planar, false),
                                         std::tuple(EndStyle::none, false), std::tuple(EndStyle::patch, true),
                                         std::tuple(EndStyle::fan, true), std::tuple(EndStyle::planar, true)),
                         [](const auto& chosen) {
                           return std::string(yarn::name_of(std::get<0>(chosen.param))) +
                                  (std::get<1>(chosen.param) ? "_solid" : "_surfaces");
                         });

TEST(Oracle, RingIsRight) {
  expect_right("ring.igs", {ring("ring")});
  expect_right("ring-solid.igs", {ring("ring")}, solids());
}

TEST(Oracle, RationalYarnsAreRight) {
  for (const EndStyle ends : {EndStyle::patch, EndStyle::fan, EndStyle::planar})
    for (const bool solid : {false, true})
      expect_right("rational.igs", {wave("r", {.weight_step = 0.37}, ends)}, solid ? solids() : surfaces());
}

TEST(Oracle, YarnsThatRunTheOtherWayRoundAreRight) {
  for (const EndStyle ends : {EndStyle::patch, EndStyle::planar}) {
    const yarn::Body body = wave("r", {.reversed = true}, ends);
    ASSERT_TRUE(body.inward);
    for (const bool solid : {false, true})
      expect_right("reversed.igs", {body}, solid ? solids() : surfaces());
  }
}

TEST(Oracle, UnitsAndNamesAreRight) {
  for (const Unit units : all_units) {
    std::vector<yarn::Body> bodies = plain_weave(EndStyle::patch);
    bodies[0].name =
        "a yarn with a name that is longer than one line of parameters, by a good deal of it, ending here";
    bodies[1].name = "Sch\xC3\xBCtze \xE2\x84\x96 1";  // two and three bytes in UTF-8
    bodies[2].name = "semicolon;comma,5Hquote";
    bodies[3].role = yarn::Role::binder;
    formats::SurfaceOptions options = surfaces(units);
    options.title = "units; " + std::string(name_of(units));
    if (units == Unit::inch) options.title += std::string(200, 'x');
    expect_right(std::string(name_of(units)) + ".igs", bodies, options);
  }
  expect_right("untitled.igs", plain_weave(EndStyle::patch));
}

TEST(Oracle, ExtremeNumbersAreRight) {
  yarn::Body body = wave("w", {}, EndStyle::none);
  const double values[] = {1e300,
                           -1e-300,
                           5e-324,
                           -0.0,
                           1.7976931348623157e308,
                           2.2250738585072014e-308,
                           1e22,
                           1e23,
                           123456,
                           1e5,
                           -2.2250738585072014e-308,
                           0.1,
                           1e-5,
                           -1e100,
                           1e21,
                           9007199254740993.0,
                           4.35,
                           1.0 / 3};
  for (std::size_t i = 0; i < std::size(values); ++i) body.surface.points[i + 40].y() = values[i];
  // Such coordinates cannot be evaluated; the file alone, and its numbers in the order of the model.
  const auto file = write_iges("extreme.igs", {body});
  const Output verdict = judge(file);
  EXPECT_EQ(verdict.exit_code, 0) << verdict.text;
  std::ifstream text(file);
  std::string line, parameters;
  while (std::getline(text, line))
    if (line[72] == 'P' && line.substr(64, 8) == "       5")
      parameters += line.substr(0, line.find_last_not_of(' ', 63) + 1);
  std::vector<double> read;
  for (std::size_t at = 0; at < parameters.size();) {
    const std::size_t end = parameters.find_first_of(",;", at);
    read.push_back(std::strtod(parameters.substr(at, end - at).c_str(), nullptr));
    at = end + 1;
  }
  const std::size_t first =
      10 + body.surface.knots_u.size() + body.surface.knots_v.size() + body.surface.points.size();
  ASSERT_EQ(read.size(), first + 3 * body.surface.points.size() + 4 + 3);
  for (std::size_t i = 0; i < body.surface.points.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const double own = body.surface.points[i][k], other = read[first + 3 * i + static_cast<std::size_t>(k)];
      EXPECT_EQ(std::signbit(own), std::signbit(other));
      EXPECT_EQ(own, other);
    }
}

TEST(Oracle, SamplesAreRight) {
  for (const char* name : {"plain4_grid.txt", "plain4_path.txt", "ring.txt"})
    for (const EndStyle ends : {EndStyle::patch, EndStyle::fan, EndStyle::planar}) {
      formats::SurfaceOptions options;
      const std::vector<yarn::Body> bodies = sample(name, ends, &options.units);
      ASSERT_FALSE(bodies.empty());
      options.expected_bodies = bodies.size();
      SCOPED_TRACE(name);
      expect_right("sample.igs", bodies, options);
    }
}

TEST(Oracle, SampleSolidsAreRight) {
  for (const char* name : {"plain4_grid.txt", "ring.txt"}) {
    formats::SurfaceOptions options = solids();
    std::vector<yarn::Body> bodies = sample(name, EndStyle::patch, &options.units);
    ASSERT_FALSE(bodies.empty());
    bodies.resize(1);
    expect_right("sample.igs", bodies, options);
  }
}

// The judge itself: each of these small faults must be found.
TEST(Oracle, FindsFaults) {
  formats::SurfaceOptions options;
  const std::vector<yarn::Body> bodies = plain_weave(EndStyle::patch);
  const auto good = write_iges("good.igs", bodies, options);
  std::ifstream stream(good, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  const auto model = dump_model("good.igs", bodies, options);
  ASSERT_EQ(judge(good, model).exit_code, 0);

  const auto line_of = [&](const std::string& beginning) {
    const std::size_t at = bytes.find("\n" + beginning);
    EXPECT_NE(at, std::string::npos) << beginning;
    return at + 1;
  };
  const std::size_t body = line_of("128,17,15,2,3,1,0,1,0,0,"), points = body + 150 * 81,
                    group = line_of("402,3,");
  struct Fault {
    const char* what;
    std::size_t at;
    std::string text;
  };
  const std::string digit = bytes.substr(points + 6, 1);
  for (const Fault& fault :
       {Fault{"a digit of a coordinate", points + 6, digit == "3" ? "4" : "3"},
        {"a closedness flag", body + 14, "0"},
        {"a sequence number", points + 79, "x"},
        {"the pointer of a parameter line", points + 71, "7"},
        {"a member of a group", group + 6, "1"},
        {"the section letter", points + 72, "D"},
        {"the newline", points + 80, " "},
        {"the line count of a directory entry", bytes.find("     128       0") + 31, "9"},
        {"the count of the terminate line", bytes.rfind("S      ") + 22, "9"}}) {
    std::string broken = bytes;
    ASSERT_NE(broken.substr(fault.at, fault.text.size()), fault.text) << fault.what;
    broken.replace(fault.at, fault.text.size(), fault.text);
    const auto path = scratch() / "broken.igs";
    std::ofstream(path, std::ios::binary) << broken;
    const Output verdict = judge(path, model);
    EXPECT_EQ(verdict.exit_code, 1) << fault.what << ": " << verdict.text;
  }
}

}  // namespace
}  // namespace selvage::test
