// Arrays of instances, and what is offset from something, from texts made by hand.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cad/measure.h"
#include "formats/iges/reading.h"
#include "nurbs/measure.h"
#include "nurbs/spline.h"

namespace selvage::test {

namespace {

using std::numbers::pi;

constexpr const char* physically_dependent = "00010000";

// The first corners of all faces, by x, then y.
std::vector<Vec3> corners(const IgesText& file) {
  const IgesReading reading = read_iges(file.bytes());
  EXPECT_TRUE(reading.model) << reading.text();
  EXPECT_EQ(reading.text(), "");
  std::vector<Vec3> all;
  if (reading.model)
    for (const cad::Part& part : reading.model->parts)
      for (const cad::Face& face : part.faces) all.push_back(face.surface.points.front());
  std::ranges::sort(
      all, [](const Vec3& a, const Vec3& b) { return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y()); });
  return all;
}

void expect_near(const std::vector<Vec3>& found, const std::vector<Vec3>& due) {
  ASSERT_EQ(found.size(), due.size());
  for (std::size_t i = 0; i < due.size(); ++i) EXPECT_LT((found[i] - due[i]).norm(), 1e-12) << i;
}

// 3 columns and 2 rows at half the size, without place 4: the second one in the second column.
TEST(IgesArrays, RectangularCountsUpTheColumns) {
  IgesText file;
  const int face = file.add({.type = 128, .parameters = bilinear(0, 0, 0), .status = physically_dependent});
  file.add({.type = 412, .parameters = fmt::format("{},.5,10.,20.,30.,3,2,4.,7.,0.,1,1,4", face)});
  expect_near(corners(file), {{10, 20, 30}, {10, 27, 30}, {14, 20, 30}, {18, 20, 30}, {18, 27, 30}});
  const IgesReading reading = read_iges(file.bytes());
  EXPECT_EQ(reading.model->parts.at(0).faces.at(0).surface.points.at(3), Vec3(10.5, 20.5, 30));
}

// Turned by a right angle: rows go towards -x, and what is copied keeps its own axes.
TEST(IgesArrays, RectangularIsTurnedAndItsCopiesAreNot) {
  IgesText file;
  const int face = file.add({.type = 128, .parameters = bilinear(0, 0, 0), .status = physically_dependent});
  const int figure =
      file.add({.type = 308, .parameters = fmt::format("0,1HA,1,{}", face), .status = "00000200"});
  file.add({.type = 412, .parameters = fmt::format("{},1.,0.,0.,0.,2,2,4.,7.,{:.17g},0,0", figure, pi / 2)});
  expect_near(corners(file), {{-7, 0, 0}, {-7, 4, 0}, {0, 0, 0}, {0, 4, 0}});
  const IgesReading reading = read_iges(file.bytes());
  for (const cad::Part& part : reading.model->parts) {
    const std::vector<Vec3>& points = part.faces.at(0).surface.points;
    EXPECT_LT((points[1] - points[0] - Vec3::UnitX()).norm(), 1e-12);
  }
}

// Six places round a circle of radius 2, of which two are listed.
TEST(IgesArrays, CircularTakesWhatIsListed) {
  IgesText file;
  const int face = file.add({.type = 128, .parameters = bilinear(0, 0, 0), .status = physically_dependent});
  file.add({.type = 414,
            .parameters = fmt::format("{},6,1.,1.,5.,2.,{:.17g},{:.17g},2,0,1,4", face, pi / 2, pi / 3)});
  expect_near(corners(file), {{1, -1, 5}, {1, 3, 5}});
}

TEST(IgesArrays, BadInput) {
  const auto fails = [](const std::string& array, int type, const std::string& words) {
    IgesText file;
    file.add({.type = 128, .parameters = bilinear(0, 0, 0), .status = physically_dependent});
    file.add({.type = type, .parameters = array});
    const IgesReading reading = read_iges(file.bytes());
    EXPECT_FALSE(reading.model) << array;
    EXPECT_TRUE(reading.says(Severity::error, words)) << reading.text();
  };
  fails("1,1.,0.,0.,0.,0,2,1.,1.,0.,0,0", 412, "an array of 0 places");
  fails("1,1.,0.,0.,0.,1000000,1000000,1.,1.,0.,0,0", 412, "an array of 1000000000000 places");
  fails("1,1.,0.,0.,0.,2,2,1.,1.,0.,1,0,5", 412, "there is no place 5 in an array of 4");
  fails("1,0.,0.,0.,0.,2,2,1.,1.,0.,0,0", 412, "at a scale of 0");
  fails("3,1.,0.,0.,0.,2,2,1.,1.,0.,0,0", 412, "it holds itself");
  fails("9,6,0.,0.,0.,1.,0.,1.,0,0", 414, "no entity begins at line 9");
  fails("1,6,0.,0.,0.,1.,0.,1.,99999,0", 414, "more than");
}

nurbs::Curve curve_of(const IgesText& file) {
  const IgesReading reading = read_iges(file.bytes());
  EXPECT_TRUE(reading.model && reading.model->curves.size() == 1) << reading.text();
  EXPECT_EQ(reading.text(), "");
  return reading.model && !reading.model->curves.empty() ? reading.model->curves.front().curve
                                                         : nurbs::Curve{};
}

// The normal times the tangent tells the side: of a half circle about z that is towards its middle.
TEST(IgesOffsets, OfAnArc) {
  IgesText file;
  const int arc =
      file.add({.type = 100, .parameters = "1.,0.,0.,2.,0.,-2.,0.", .status = physically_dependent});
  file.add({.type = 130, .parameters = fmt::format("{},1,0,0,0,.5,0.,0.,0.,0.,0.,1.,0.,{:.17g}", arc, pi)});
  const nurbs::Curve curve = curve_of(file);
  EXPECT_NEAR(nurbs::arc_length(curve), 1.5 * pi, 1e-7);
  for (const double t : {0.0, 0.7, 3.0})
    EXPECT_NEAR((nurbs::evaluate(curve, t) - Vec3(0, 0, 1)).norm(), 1.5, 1e-7);
}

// A line along x whose distance grows with its length from 1 to 2: a line at a slope.
TEST(IgesOffsets, OfALineWithADistanceThatGrows) {
  IgesText file;
  const int line = file.add({.type = 110, .parameters = "0.,0.,0.,4.,0.,0.", .status = physically_dependent});
  file.add({.type = 130, .parameters = fmt::format("{},2,0,0,1,1.,0.,2.,4.,0.,0.,1.,0.,1.", line)});
  const nurbs::Curve curve = curve_of(file);
  EXPECT_LT((nurbs::evaluate(curve, curve.first_parameter()) - Vec3(0, 1, 0)).norm(), 1e-9);
  EXPECT_LT((nurbs::evaluate(curve, curve.last_parameter()) - Vec3(4, 2, 0)).norm(), 1e-9);
  EXPECT_NEAR(nurbs::arc_length(curve), std::sqrt(17.0), 1e-9);
}

// The third kind: the y of another curve, y = x, at the base's parameter 0 .. 1.
TEST(IgesOffsets, OfALineByAFunction) {
  IgesText file;
  const int line = file.add({.type = 110, .parameters = "0.,0.,0.,4.,0.,0.", .status = physically_dependent});
  const int function =
      file.add({.type = 110, .parameters = "0.,0.,0.,1.,3.,0.", .status = physically_dependent});
  file.add(
      {.type = 130, .parameters = fmt::format("{},3,{},2,2,0.,0.,0.,0.,0.,0.,1.,0.,1.", line, function)});
  EXPECT_NEAR(nurbs::arc_length(curve_of(file)), 5, 1e-9);
}

double area_of(const IgesText& file) {
  const IgesReading reading = read_iges(file.bytes());
  EXPECT_TRUE(reading.model && reading.model->parts.size() == 1) << reading.text();
  EXPECT_EQ(reading.text(), "");
  return reading.model && !reading.model->parts.empty()
             ? nurbs::moments(reading.model->parts[0].faces.at(0).surface, Vec3::Zero()).area
             : 0;
}

// A quarter of a cylinder of radius 2 and height 3 (an arc moved along z), out by 0.5, and in.
TEST(IgesOffsets, OfACurvedSurface) {
  for (const double side : {1.0, -1.0}) {
    IgesText file;
    const int arc =
        file.add({.type = 100, .parameters = "0.,0.,0.,2.,0.,0.,2.", .status = physically_dependent});
    const int wall = file.add(
        {.type = 122, .parameters = fmt::format("{},2.,0.,3.", arc), .status = physically_dependent});
    const double s = side * std::sqrt(0.5);
    file.add({.type = 140, .parameters = fmt::format("{:.17g},{:.17g},0.,.5,{}", s, s, wall)});
    EXPECT_NEAR(area_of(file), (2 + 0.5 * side) * pi / 2 * 3, 1e-6) << side;
  }
}

// Of surfaces by formula: exactly such again.
TEST(IgesOffsets, OfASphere) {
  IgesText file;
  const int middle = file.add({.type = 116, .parameters = "1.,2.,3.,0", .status = physically_dependent});
  const int sphere =
      file.add({.type = 196, .parameters = fmt::format("{},2.", middle), .status = physically_dependent});
  file.add({.type = 140, .parameters = fmt::format("-1.,0.,0.,.5,{}", sphere)});
  EXPECT_NEAR(area_of(file), 4 * pi * 2.5 * 2.5, 1e-6);
}

// 144 on the offset of a plane, bounded by its curve in space: a disc at z = 1.5.
TEST(IgesOffsets, OfAPlaneThatIsTrimmed) {
  IgesText file;
  const int place = file.add({.type = 116, .parameters = "0.,0.,1.,0", .status = physically_dependent});
  const int up = file.add({.type = 123, .parameters = "0.,0.,1.", .status = physically_dependent});
  const int plane =
      file.add({.type = 190, .parameters = fmt::format("{},{}", place, up), .status = physically_dependent});
  const int moved = file.add(
      {.type = 140, .parameters = fmt::format("0.,0.,1.,.5,{}", plane), .status = physically_dependent});
  const int circle =
      file.add({.type = 100, .parameters = "1.5,0.,0.,2.,0.,2.,0.", .status = physically_dependent});
  const int boundary = file.add(
      {.type = 142, .parameters = fmt::format("0,{},0,{},2", moved, circle), .status = physically_dependent});
  file.add({.type = 144, .parameters = fmt::format("{},1,0,{}", moved, boundary)});
  const IgesReading reading = read_iges(file.bytes());
  ASSERT_TRUE(reading.model && reading.model->parts.size() == 1) << reading.text();
  const cad::Face& face = reading.model->parts[0].faces.at(0);
  EXPECT_EQ(face.loops.size(), 1U);
  for (const Vec3& p : face.surface.points) EXPECT_NEAR(p.z(), 1.5, 1e-12);
}

// Half a sphere between two meridians, as files have it: its boundary in the parameters runs through one pole
// in an edge of its own and leaves the other pole out, and in space there are but the two half circles.
TEST(IgesTrimmed, HalfASphereBetweenMeridians) {
  IgesText file;
  const auto dependent_one = [&](int type, const std::string& parameters) {
    return file.add({.type = type, .parameters = parameters, .status = physically_dependent});
  };
  const auto flat = [&](double u0, double v0, double u1, double v1) {
    return dependent_one(126,
                         fmt::format("1,1,1,0,1,0,0.,0.,1.,1.,1.,1.,{:.9f},{:.9f},0.,{:.9f},{:.9f},0.,0.,1.,"
                                     "0.,0.,1.",
                                     u0, v0, u1, v1));
  };
  const int axis = dependent_one(110, "0.,0.,0.,5.,0.,0.");
  const int meridian = dependent_one(100, "0.,0.,0.,5.,0.,-5.,0.");
  const int sphere = dependent_one(120, fmt::format("{},{},0.,{:.15g}", axis, meridian, 2 * pi));
  const int down = flat(pi, pi, 0, pi), pole = flat(0, pi, 0, 2 * pi), up = flat(0, 2 * pi, pi, 2 * pi);
  const int flats = dependent_one(102, fmt::format("3,{},{},{}", down, pole, up));
  const int back = dependent_one(100, "0.,0.,0.,-5.,0.,5.,0.");
  const int there = dependent_one(100, "0.,0.,0.,5.,0.,-5.,0.");
  const int arcs = dependent_one(102, fmt::format("2,{},{}", back, there));
  const int boundary = dependent_one(142, fmt::format("0,{},{},{},1", sphere, flats, arcs));
  file.add({.type = 144, .parameters = fmt::format("{},1,0,{}", sphere, boundary)});
  const IgesReading reading = read_iges(file.bytes());
  ASSERT_TRUE(reading.model && reading.model->parts.size() == 1) << reading.text();
  const cad::Part& part = reading.model->parts[0];
  const cad::Face& face = part.faces.at(0);
  ASSERT_EQ(face.loops.size(), 1U);
  EXPECT_EQ(face.loops[0].edges.size(), 4U);
  for (const cad::Edge& edge : face.loops[0].edges) EXPECT_FALSE(edge.flat.points.empty());
  const cad::PartMeasures measures = cad::measures_of(part);
  ASSERT_TRUE(measures.area);
  EXPECT_NEAR(*measures.area, 2 * pi * 25, 1e-6);
}

// A turn of so many digits is a whole one.
TEST(IgesTrimmed, AWholeTurnOfSixDigits) {
  IgesText file;
  const int axis = file.add({.type = 110, .parameters = "0.,0.,0.,5.,0.,0.", .status = physically_dependent});
  const int meridian =
      file.add({.type = 100, .parameters = "0.,0.,0.,5.,0.,-5.,0.", .status = physically_dependent});
  file.add({.type = 120, .parameters = fmt::format("{},{},0.,6.28318", axis, meridian)});
  const IgesReading reading = read_iges(file.bytes());
  ASSERT_TRUE(reading.model && reading.model->parts.size() == 1) << reading.text();
  EXPECT_NEAR(cad::measures_of(reading.model->parts[0]).area.value_or(0), 4 * pi * 25, 1e-6);
}

// The curves of a composite in directions of their own, in space: they are turned, which is told.
TEST(IgesTrimmed, CurvesThatRunAgainstEachOther) {
  for (const int turned : {0, 1, 2, 3, 5, 9, 15}) {
    IgesText file;
    const int plane =
        file.add({.type = 128, .parameters = bilinear(0, 0, 0), .status = physically_dependent});
    const std::array<std::pair<double, double>, 4> corners = {{{.1, .2}, {.7, .2}, {.7, .9}, {.1, .9}}};
    std::string chain = "4";
    for (int i = 0; i < 4; ++i) {
      auto from = corners.at(static_cast<std::size_t>(i)),
           to = corners.at(static_cast<std::size_t>((i + 1) % 4));
      if ((turned >> i & 1) != 0) std::swap(from, to);
      chain += fmt::format(",{}", file.add({.type = 110,
                                            .parameters = fmt::format("{},{},0.,{},{},0.", from.first,
                                                                      from.second, to.first, to.second),
                                            .status = physically_dependent}));
    }
    const int composite = file.add({.type = 102, .parameters = chain, .status = physically_dependent});
    const int boundary = file.add({.type = 142,
                                   .parameters = fmt::format("0,{},0,{},2", plane, composite),
                                   .status = physically_dependent});
    file.add({.type = 144, .parameters = fmt::format("{},1,0,{}", plane, boundary)});
    const IgesReading reading = read_iges(file.bytes());
    ASSERT_TRUE(reading.model && reading.model->parts.size() == 1) << reading.text();
    EXPECT_EQ(reading.says(Severity::warning, "run against each other"), turned != 0) << turned;
    const cad::PartMeasures measures = cad::measures_of(reading.model->parts[0]);
    ASSERT_TRUE(measures.area) << turned;
    EXPECT_NEAR(*measures.area, 0.6 * 0.7, 1e-9) << turned;
  }
}

TEST(IgesOffsets, BadInput) {
  const auto says = [](const std::vector<IgesEntity>& entities, Severity severity, const std::string& words) {
    IgesText file;
    for (const IgesEntity& entity : entities) file.add(entity);
    file.add({.type = 110, .parameters = "0.,0.,0.,1.,0.,0."});
    const IgesReading reading = read_iges(file.bytes());
    EXPECT_TRUE(reading.says(severity, words)) << words << ":\n" << reading.text();
  };
  const IgesEntity line{.type = 110, .parameters = "0.,0.,0.,4.,0.,0.", .status = physically_dependent};
  const IgesEntity bent{.type = 106,
                        .form = 12,
                        .parameters = "2,3,0.,0.,0.,1.,0.,0.,1.,1.,0.",
                        .status = physically_dependent};
  const IgesEntity middle{.type = 116, .parameters = "0.,0.,0.,0", .status = physically_dependent};
  const IgesEntity sphere{.type = 196, .parameters = "1,2.", .status = physically_dependent};
  says({line, {.type = 130, .parameters = "1,4,0,0,0,1.,0.,0.,0.,0.,0.,1.,0.,1."}}, Severity::error,
       "no offset of kind 4");
  says({line, {.type = 130, .parameters = "1,1,0,0,0,1.,0.,0.,0.,0.,0.,0.,0.,1."}}, Severity::error,
       "without a normal");
  says({line, {.type = 130, .parameters = "1,3,0,2,2,1.,0.,0.,0.,0.,0.,1.,0.,1."}}, Severity::error,
       "a pointer to an entity is missing");
  says({line, {.type = 130, .parameters = "1,1,0,0,0,1.,0.,0.,0.,0.,0.,1.,5.,9."}}, Severity::warning,
       "no parameters 5 to 9");
  const IgesEntity joined{.type = 102, .parameters = "1,1", .status = physically_dependent};
  says({line, joined, {.type = 130, .parameters = "3,1,0,0,0,1.,0.,0.,0.,0.,0.,1.,0.,1."}}, Severity::warning,
       "all of the composite or conic is taken");
  says({line, joined, {.type = 130, .parameters = "3,2,0,0,2,1.,0.,2.,1.,0.,0.,1.,0.,1."}}, Severity::warning,
       "which is not kept");
  says({bent, {.type = 130, .parameters = "1,1,0,0,0,.2,0.,0.,0.,0.,0.,1.,0.,2."}}, Severity::warning,
       "a corner or a cusp");
  says({middle, sphere, {.type = 140, .parameters = "1.,0.,0.,2.,3"}}, Severity::warning, "nothing is left");
  says({{.type = 140, .parameters = "1.,0.,0.,2.,1"}}, Severity::error, "part of itself");
}

}  // namespace

}  // namespace selvage::test
