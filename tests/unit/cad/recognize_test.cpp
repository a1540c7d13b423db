// take_yarns and fabric_of: yarns whose faces are known, in every form that other programs may give them.
#include "cad/recognize.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "cad/from_body.h"
#include "fabric/from_cad.h"
#include "formats/iges/bodies.h"
#include "unit/cad/surfaces.h"
#include "yarn/finish.h"
#include "yarn/grid.h"

namespace selvage::test {
namespace {

using cad::Face;
using cad::FoundYarn;
using cad::Model;
using cad::Part;
using nurbs::Surface;
using std::numbers::pi;
using yarn::Body;
using yarn::EndStyle;

// A control point with its weight, by its bits.
using Bits = std::array<std::uint64_t, 4>;
// The control points of a surface, in whatever order.
using Bag = std::vector<Bits>;

Bag bag_of(const Surface& surface) {
  Bag bag;
  for (std::size_t k = 0; k < surface.points.size(); ++k) {
    const Vec3& p = surface.points[k];
    const double weight = surface.is_rational() ? surface.weights[k] : 1;
    bag.push_back({std::bit_cast<std::uint64_t>(p.x()), std::bit_cast<std::uint64_t>(p.y()),
                   std::bit_cast<std::uint64_t>(p.z()), std::bit_cast<std::uint64_t>(weight)});
  }
  std::sort(bag.begin(), bag.end());
  return bag;
}

// What has to survive of a yarn: its side, and its two ends in either order.
struct Print {
  Bag side;
  bool is_ring = false;
  std::array<std::pair<EndStyle, Bag>, 2> ends;
  double volume = 0;  // compared by itself
  [[nodiscard]] auto key() const { return std::tie(side, is_ring, ends); }
};

Print print_of(Body body) {
  const Status status = yarn::finish_as_sealed(body);
  EXPECT_TRUE(status.ok());
  Print print{bag_of(body.surface),
              body.closed_along,
              {std::pair(body.start.style, bag_of(body.start.surface)),
               std::pair(body.end.style, bag_of(body.end.surface))},
              body.volume};
  std::sort(print.ends.begin(), print.ends.end());
  return print;
}

std::vector<Print> sorted(std::vector<Print> prints) {
  std::sort(prints.begin(), prints.end(), [](const Print& a, const Print& b) { return a.key() < b.key(); });
  return prints;
}

std::vector<Print> prints_of(const std::vector<Body>& bodies) {
  std::vector<Print> prints;
  for (const Body& body : bodies) prints.push_back(print_of(body));
  return sorted(std::move(prints));
}

std::vector<Body> bodies_of(const std::vector<FoundYarn>& found) {
  std::vector<Body> bodies;
  for (const FoundYarn& yarn : found) bodies.push_back(yarn.body);
  return bodies;
}

std::vector<Body> bodies_of(const fabric::Fabric& fabric) {
  std::vector<Body> bodies;
  for (const fabric::Item& item : fabric.items)
    bodies.push_back(*std::get<fabric::ReadBody>(std::get<fabric::Yarn>(item).shape));
  return bodies;
}

void expect_same(const std::vector<Body>& found, const std::vector<Body>& wanted) {
  const std::vector<Print> a = prints_of(found), b = prints_of(wanted);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_TRUE(a[k].side == b[k].side) << k;
    EXPECT_EQ(a[k].is_ring, b[k].is_ring) << k;
    for (std::size_t e = 0; e < 2; ++e) {
      EXPECT_EQ(name_of(a[k].ends[e].first), name_of(b[k].ends[e].first)) << k;
      EXPECT_TRUE(a[k].ends[e].second == b[k].ends[e].second) << k;
    }
    EXPECT_GT(a[k].volume, 0);
    EXPECT_NEAR(a[k].volume, b[k].volume, 1e-12 * b[k].volume) << k;
  }
}

std::size_t faces_of(const std::vector<Body>& bodies) {
  std::size_t faces = 0;
  for (const Body& body : bodies) {
    ++faces;
    for (const yarn::EndFace* end : {&body.start, &body.end}) faces += end->style == EndStyle::none ? 0 : 1;
  }
  return faces;
}

Model model_of(const std::vector<Body>& bodies) {
  Model model;
  model.file = "test";
  for (const Body& body : bodies) model.parts.push_back(cad::part_of(body));
  return model;
}

// Every face a part of its own, without names, colours and levels, in an order that tells nothing.
Model loosened(const Model& model, unsigned seed = 7) {
  Model loose;
  loose.file = model.file;
  for (const Part& part : model.parts)
    for (const Face& face : part.faces) {
      Part& single = loose.parts.emplace_back();
      single.faces.emplace_back();
      single.faces.back().surface = face.surface;
      single.faces.back().reversed = face.reversed;
      single.faces.back().loops = face.loops;
    }
  std::mt19937 random(seed);  // NOLINT: the same order each time
  for (std::size_t k = loose.parts.size(); k > 1; --k)
    std::swap(loose.parts[k - 1], loose.parts[random() % k]);
  return loose;
}

std::vector<FoundYarn> taken(Model& model) {
  Diagnostics diagnostics;
  const std::size_t faces = model.face_count();
  std::vector<FoundYarn> found = cad::take_yarns(model, diagnostics);
  EXPECT_EQ(faces_of(bodies_of(found)) + model.face_count(), faces);
  EXPECT_TRUE(diagnostics.messages().empty()) << diagnostics.messages().front().text;
  return found;
}

// Takes the yarns, by take_yarns and by fabric_of: they are `wanted`, and `rest` faces stay.
void expect_taken(Model model, const std::vector<Body>& wanted, std::size_t rest = 0) {
  Diagnostics diagnostics;
  const fabric::Fabric fabric = fabric::fabric_of(model, diagnostics);
  expect_same(bodies_of(taken(model)), wanted);
  EXPECT_EQ(model.face_count(), rest);
  expect_same(bodies_of(fabric), wanted);
  std::size_t kept = 0;
  for (const Part& part : fabric.parts) kept += part.faces.size();
  EXPECT_EQ(kept, rest);
  std::set<std::string> names;
  for (const Body& body : bodies_of(fabric)) names.insert(body.name);
  EXPECT_EQ(names.size(), wanted.size());
  EXPECT_FALSE(names.contains(""));
}

// One of each kind, none near another.
std::vector<Body> specimens() {
  std::vector<Body> bodies = {wave("patched", {.y = 0}, EndStyle::patch),
                              wave("fanned", {.y = 1, .phase = 0.3}, EndStyle::fan),
                              wave("flat", {.y = 2, .phase = 0.7}, EndStyle::planar),
                              wave("open", {.y = 3}, EndStyle::none),
                              wave("inside out", {.y = 4, .reversed = true}, EndStyle::patch),
                              wave("weighted", {.y = 5, .weight_step = 0.4}, EndStyle::patch),
                              wave("weighted fan", {.y = 6, .weight_step = 0.4}, EndStyle::fan),
                              wave("weighted flat", {.y = 7, .weight_step = 0.4}, EndStyle::planar)};
  bodies.push_back(ring("ring"));
  for (Vec3& p : bodies.back().surface.points) p += Vec3(30, 0, 0);
  for (Vec3& p : bodies.back().axis.points) p += Vec3(30, 0, 0);
  return bodies;
}

// Points and weights of every row (or column) in the other order; the knots mirrored.
Surface backward(const Surface& s, bool in_u) {
  Surface out = s;
  std::vector<double>& knots = in_u ? out.knots_u : out.knots_v;
  const double sum = knots.front() + knots.back();
  std::reverse(knots.begin(), knots.end());
  for (double& knot : knots) knot = sum - knot;
  for (int j = 0; j < s.count_v; ++j)
    for (int i = 0; i < s.count_u; ++i) {
      const std::size_t from = in_u ? s.index(s.count_u - 1 - i, j) : s.index(i, s.count_v - 1 - j);
      out.points[s.index(i, j)] = s.points[from];
      if (s.is_rational()) out.weights[s.index(i, j)] = s.weights[from];
    }
  return out;
}

struct Form {
  std::string name;
  bool swap = false, back_u = false, back_v = false, loose = false;
};

class Recognized : public testing::TestWithParam<Form> {};

TEST_P(Recognized, EveryKindOfYarn) {
  const Form& form = GetParam();
  const std::vector<Body> bodies = specimens();
  Model model = model_of(bodies);
  for (Part& part : model.parts)
    for (Face& face : part.faces) {
      if (!face.loops.empty()) continue;  // a plane: its loop's flat curve is in its parameters
      if (form.swap) face.surface = swapped(face.surface);
      if (form.back_u) face.surface = backward(face.surface, true);
      if (form.back_v) face.surface = backward(face.surface, false);
      if (static_cast<int>(form.swap) + static_cast<int>(form.back_u) + static_cast<int>(form.back_v) == 1)
        face.reversed = !face.reversed;
    }
  expect_taken(form.loose ? loosened(model) : model, bodies);
}

INSTANTIATE_TEST_SUITE_P(
    Recognize, Recognized,
    testing::Values(Form{.name = "AsItIs"}, Form{.name = "Transposed", .swap = true},
                    Form{.name = "BackwardU", .back_u = true}, Form{.name = "BackwardV", .back_v = true},
                    Form{.name = "BackwardBoth", .back_u = true, .back_v = true},
                    Form{.name = "TransposedBackwardU", .swap = true, .back_u = true},
                    Form{.name = "Loose", .loose = true},
                    Form{.name = "LooseTransposed", .swap = true, .loose = true},
                    Form{.name = "LooseBackwardU", .back_u = true, .loose = true},
                    Form{.name = "LooseBackwardV", .back_v = true, .loose = true},
                    Form{.name = "LooseTransposedBackwardV", .swap = true, .back_v = true, .loose = true}),
    [](const testing::TestParamInfo<Form>& form) { return form.param.name; });

TEST(Recognize, NameColourRoleAndSolidityComeFromTheFile) {
  std::vector<Body> bodies = plain_weave(EndStyle::patch);
  Model model = model_of(bodies);
  for (std::size_t k = 0; k < yarn::all_roles.size(); ++k)
    model.levels[static_cast<int>(k) + 1] = yarn::name_of(yarn::all_roles[k]);
  const std::vector<FoundYarn> found = taken(model);
  ASSERT_EQ(found.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(found[k].body.name, bodies[k].name);
    EXPECT_EQ(found[k].body.color, bodies[k].color);
    EXPECT_EQ(found[k].body.role, bodies[k].role);
    EXPECT_EQ(found[k].body.quarters, bodies[k].quarters);
    EXPECT_TRUE(found[k].was_solid);
    EXPECT_TRUE(found[k].body.is_named && found[k].body.is_colored);
  }
  Model loose = loosened(model_of(bodies));
  for (const FoundYarn& yarn : taken(loose))
    EXPECT_FALSE(yarn.was_solid || yarn.body.is_named || yarn.body.is_colored);
}

// The area inside the closed uniform quadratic B-spline over n points of an ellipse with half axes a and b:
// the sum of P_i x P_i+1 10/24 + P_i x P_i+2 1/24 (the derivative of the quintic B-spline at 1 and 2).
double quadratic_area(int n, double a, double b) {
  const double step = 2 * pi / n;
  return n * a * b * (10 * std::sin(step) + std::sin(2 * step)) / 24;
}
// The same for the cubic (the seventh degree's derivative).
double cubic_area(int n) {
  const double step = 2 * pi / n;
  return n * (245 * std::sin(step) + 56 * std::sin(2 * step) + std::sin(3 * step)) / 720;
}

double only_volume(Model model) {
  const std::vector<FoundYarn> found = taken(model);
  EXPECT_EQ(found.size(), 1U);
  return found.empty() ? 0 : print_of(found.front().body).volume;
}

TEST(Recognize, VolumesOfStraightYarnsAndRingsAreThoseOfTheirSplines) {
  const double straight = quadratic_area(16, 0.2, 0.1) * 4;
  for (const EndStyle ends : {EndStyle::patch, EndStyle::fan, EndStyle::planar, EndStyle::none}) {
    const Model model = model_of({wave("straight", {.amplitude = 0}, ends)});
    EXPECT_NEAR(only_volume(model), straight, 1e-12 * straight) << name_of(ends);
    EXPECT_NEAR(only_volume(loosened(model)), straight, 1e-12 * straight) << name_of(ends);
  }
  // Pappus: the section is symmetric about its centre, so its radius weighs as 5.
  const double round = 5 * quadratic_area(16, 0.5, 0.5) * 2 * cubic_area(12);
  EXPECT_NEAR(only_volume(model_of({ring("ring")})), round, 1e-12 * round);
  EXPECT_NEAR(only_volume(loosened(model_of({ring("ring")}))), round, 1e-12 * round);
}

// What the quadrature of rational surfaces leaves.
constexpr double rational_error = 1e-12;

Body body_of(const std::string& name, Surface surface, EndStyle ends, bool is_ring = false) {
  Body body;
  body.name = name;
  body.surface = std::move(surface);
  body.closed_along = is_ring;
  body.axis = yarn::section_centres(body.surface);
  body.quarters = yarn::quarters_of(body.surface);
  EXPECT_TRUE(yarn::finish(body, ends).ok());
  return body;
}

// A rational torus about z, exactly round.
Surface torus(double major, double minor) {
  const Surface section = cylinder(minor, 1);
  Surface s = section;
  s.degree_v = 2;
  s.count_v = 9;
  s.knots_v = section.knots_u;
  s.points.clear();
  s.weights.clear();
  const Surface round = cylinder(1, 1);
  for (int j = 0; j < 9; ++j)
    for (int i = 0; i < 9; ++i) {
      // The seam's columns and rows are to be equal to the bit.
      const Vec3 out = round.point(j % 8, 0), at = section.point(i % 8, 0);
      s.points.emplace_back(Vec3((major + at.x()) * out.x(), (major + at.x()) * out.y(), -at.y()));
      s.weights.push_back(round.weight(j, 0) * section.weight(i, 0));
    }
  return s;
}

TEST(Recognize, ExactCylindersAndTori) {
  for (const EndStyle ends : {EndStyle::patch, EndStyle::fan, EndStyle::planar, EndStyle::none}) {
    const Body body = body_of("cylinder", cylinder(0.25, 3, 1, 2), ends);
    expect_taken(model_of({body}), {body});
    expect_taken(loosened(model_of({body})), {body});
    const double volume = pi * 0.25 * 0.25 * 3;
    EXPECT_NEAR(only_volume(model_of({body})), volume, rational_error * volume) << name_of(ends);
  }
  const Body body = body_of("torus", torus(2, 0.5), EndStyle::none, true);
  expect_taken(model_of({body}), {body});
  const double volume = 2 * pi * pi * 2 * 0.25;
  EXPECT_NEAR(only_volume(model_of({body})), volume, rational_error * volume);
}

TEST(Recognize, PointsThatMissByABillionthAreStillSealed) {
  const std::vector<Body> bodies = specimens();
  for (const bool loose : {false, true}) {
    Model model = model_of(bodies);
    std::mt19937 random(3);  // NOLINT: the same points each time
    std::uniform_real_distribution<double> offset(-1e-9, 1e-9);
    const auto shake = [&](std::vector<Vec3>& points) {
      for (Vec3& p : points) p += 0.2 * Vec3(offset(random), offset(random), offset(random));
    };
    std::set<Bits> given;
    for (Part& part : model.parts)
      for (Face& face : part.faces) {
        if (face.loops.empty()) {
          shake(face.surface.points);
          for (const Bits& bits : bag_of(face.surface)) given.insert(bits);
        } else {
          shake(face.loops.front().edges.front().curve.points);
        }
      }
    if (loose) model = loosened(model);
    const std::vector<FoundYarn> found = taken(model);
    EXPECT_EQ(model.face_count(), 0U);
    ASSERT_EQ(found.size(), bodies.size());
    double volume = 0, wanted = 0;
    std::multiset<std::string_view> styles, wanted_styles;
    for (std::size_t k = 0; k < found.size(); ++k) {
      const Print print = print_of(found[k].body), before = print_of(bodies[k]);
      volume += print.volume;
      wanted += before.volume;
      for (std::size_t e = 0; e < 2; ++e) {
        styles.insert(name_of(print.ends[e].first));
        wanted_styles.insert(name_of(before.ends[e].first));
        for (const Bits& bits : print.ends[e].second) EXPECT_TRUE(given.contains(bits));
      }
      for (const Bits& bits : print.side) EXPECT_TRUE(given.contains(bits));
    }
    EXPECT_EQ(styles, wanted_styles);
    EXPECT_NEAR(volume, wanted, 1e-8 * wanted);
    EXPECT_NE(volume, wanted);
  }
}

TEST(Recognize, AnEndFaceThatIsElsewhereIsToldAndKept) {
  const Body body = wave("yarn", {}, EndStyle::patch);
  for (const bool loose : {false, true}) {
    Model model = model_of({body});
    model.parts[0].kind = Part::Kind::surfaces;
    for (Vec3& p : model.parts[0].faces[2].surface.points) p.y() += 0.01 * 0.4;
    const Bag moved = bag_of(model.parts[0].faces[2].surface);
    if (loose) model = loosened(model);
    Diagnostics diagnostics;
    const std::vector<FoundYarn> found = cad::take_yarns(model, diagnostics);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].body.start.style, EndStyle::patch);
    EXPECT_EQ(found[0].body.end.style, EndStyle::none);
    EXPECT_TRUE(bag_of(found[0].body.surface) == bag_of(body.surface));
    EXPECT_TRUE(bag_of(found[0].body.start.surface) == bag_of(body.start.surface));
    ASSERT_EQ(model.face_count(), 1U);
    EXPECT_TRUE(bag_of(model.parts.at(0).faces.at(0).surface) == moved);
    ASSERT_EQ(diagnostics.messages().size(), 1U);
    EXPECT_NE(diagnostics.messages()[0].text.find("open ends"), std::string::npos);
    EXPECT_EQ(diagnostics.messages()[0].severity, Severity::warning);
  }
}

TEST(Recognize, ASolidWhoseEndIsElsewhereStaysAsItIs) {
  Model model = model_of({wave("yarn", {}, EndStyle::patch)});
  for (Vec3& p : model.parts[0].faces[2].surface.points) p.y() += 0.01 * 0.4;
  const Model before = model;
  EXPECT_TRUE(taken(model).empty());
  ASSERT_EQ(model.parts.size(), 1U);
  ASSERT_EQ(model.parts[0].faces.size(), 3U);
  for (std::size_t f = 0; f < 3; ++f)
    EXPECT_TRUE(bag_of(model.parts[0].faces[f].surface) == bag_of(before.parts[0].faces[f].surface));
}

// The faces of all yarns together: where two yarns meet in equal outlines either may have either's end face.
std::vector<Bag> all_faces(const std::vector<Body>& bodies) {
  std::vector<Bag> bags;
  for (const Body& body : bodies)
    for (const Surface* s : {&body.surface, &body.start.surface, &body.end.surface})
      bags.push_back(bag_of(*s));
  std::sort(bags.begin(), bags.end());
  return bags;
}

TEST(Recognize, TwoYarnsThatTouchEndToEnd) {
  for (const EndStyle ends : {EndStyle::patch, EndStyle::fan}) {
    const Body first = wave("first", {}, ends);
    Body second = first;  // its image in the plane of the end
    second.name = "second";
    for (std::vector<Vec3>* points : {&second.surface.points, &second.axis.points,
                                      &second.start.surface.points, &second.end.surface.points})
      for (Vec3& p : *points) p.x() = 8 - p.x();
    ASSERT_TRUE(yarn::finish_as_sealed(second).ok());
    ASSERT_EQ(yarn::end_curve(first, true).points, yarn::end_curve(second, true).points);
    expect_taken(model_of({first, second}), {first, second});
    for (const unsigned seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
      Model model = loosened(model_of({first, second}), seed);
      const std::vector<FoundYarn> found = taken(model);
      ASSERT_EQ(found.size(), 2U);
      EXPECT_TRUE(all_faces(bodies_of(found)) == all_faces({first, second}));
      for (const FoundYarn& yarn : found) {
        const Print print = print_of(yarn.body);
        EXPECT_NEAR(print.volume, first.volume, 1e-12 * first.volume);
        for (const auto& end : print.ends) EXPECT_EQ(end.first, ends);
      }
    }
  }
}

TEST(Recognize, TwoEqualYarnsInOnePlace) {
  for (const EndStyle ends : {EndStyle::patch, EndStyle::fan, EndStyle::planar}) {
    const std::vector<Body> twice(2, wave("yarn", {}, ends));
    expect_taken(model_of(twice), twice);
    for (const unsigned seed : {1U, 2U, 3U, 4U}) expect_taken(loosened(model_of(twice), seed), twice);
  }
}

// More than are tried of one face at a time.
TEST(Recognize, HundredEqualYarnsInOnePlace) {
  for (const EndStyle ends : {EndStyle::patch, EndStyle::planar}) {
    const std::vector<Body> many(100, wave("yarn", {.sections = 4, .round = 8}, ends));
    for (const unsigned seed : {1U, 2U}) expect_taken(loosened(model_of(many), seed), many);
  }
}

TEST(Recognize, WhatIsNoYarnStays) {
  Surface half = cylinder(0.2, 2, 10, 10);
  const Surface whole = half;
  half.count_u = 5;
  half.knots_u = {0, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.5};
  half.points.clear();
  half.weights.clear();
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 5; ++i) {
      half.points.push_back(whole.point(i, j));
      half.weights.push_back(whole.weight(i, j));
    }
  Surface plane;
  plane.degree_u = plane.degree_v = 1;
  plane.count_u = plane.count_v = 2;
  plane.knots_u = plane.knots_v = {0, 0, 1, 1};
  plane.points = {{20, 0, 0}, {21, 0, 0}, {20, 1, 0}, {21, 1, 0}};
  const Body yarn = wave("yarn", {}, EndStyle::patch);
  Model model = model_of({yarn});
  for (const Surface& surface : {half, plane, sheet()})
    model.parts.insert(model.parts.begin(), part_of("other", {surface}));
  expect_taken(model, {yarn}, 3);
  expect_taken(loosened(model), {yarn}, 3);
  Model others = model;
  others.parts.pop_back();
  EXPECT_TRUE(taken(others).empty());
  ASSERT_EQ(others.parts.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(others.parts[k].name, "other");
    EXPECT_TRUE(bag_of(others.parts[k].faces.at(0).surface) == bag_of(model.parts[k].faces[0].surface));
  }
}

// Among other surfaces a tube without end faces is a hole or a pin; alone, a yarn with open ends.
TEST(Recognize, ATubeAmongOtherSurfacesIsNoYarn) {
  Model model;
  model.parts = {part_of("hole", {cylinder(0.2, 2, 10, 10)}), part_of("sheet", {sheet()})};
  EXPECT_TRUE(taken(model).empty());
  EXPECT_EQ(model.parts.size(), 2U);
  Model alone;
  alone.parts = {part_of("sleeve", {cylinder(0.2, 2, 10, 10)})};
  const std::vector<FoundYarn> found = taken(alone);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].body.start.style, EndStyle::none);
}

TEST(Recognize, ADiscWithOneFaceIsNoYarn) {
  Surface bottom = cylinder(0.2, 1, 10, 10);
  for (int i = 0; i < bottom.count_u; ++i) bottom.point(i, 1) = Vec3(10, 10, 0);
  for (const double height : {0.05, 2.0}) {  // 0.4 across
    Model model;
    model.parts = {part_of("tube", {cylinder(0.2, height, 10, 10), bottom}), part_of("sheet", {sheet()})};
    Diagnostics diagnostics;  // the yarn's end is made anew
    EXPECT_EQ(cad::take_yarns(model, diagnostics).size(), height > 1 ? 1U : 0U);
  }
}

// A vase: two walls, each with its bottom, joined by the rim. What is inside of the outer one overlaps
// nothing.
TEST(Recognize, TheWallsOfAVaseAreNoYarns) {
  Surface outer = cylinder(0.3, 2, 10, 10), inner = cylinder(0.2, 2, 10, 10);
  for (int i = 0; i < inner.count_u; ++i) inner.point(i, 0).z() = 0.1;
  std::array<Surface, 2> bottoms = {outer, inner};
  for (Surface& bottom : bottoms)
    for (int i = 0; i < bottom.count_u; ++i) bottom.point(i, 1) = Vec3(10, 10, bottom.point(i, 0).z());
  Surface rim = outer;
  for (int i = 0; i < rim.count_u; ++i) {
    rim.point(i, 0) = outer.point(i, 1);
    rim.point(i, 1) = inner.point(i, 1);
  }
  Model model;
  for (const Surface& surface : {outer, bottoms[0], inner, bottoms[1], rim})
    model.parts.push_back(part_of("vase", {surface}));
  Model open = model;
  EXPECT_TRUE(taken(model).empty());
  EXPECT_EQ(model.parts.size(), 5U);
  open.parts.back() = part_of("sheet", {sheet()});
  Diagnostics diagnostics;  // without the rim they are two yarns with an open end
  EXPECT_EQ(cad::take_yarns(open, diagnostics).size(), 2U);
}

TEST(Recognize, TenThousandLooseYarns) {
  const Body model_yarn =
      wave("", {.length = 1, .width = 0.25, .height = 0.125, .amplitude = 0.05, .sections = 4, .round = 8},
           EndStyle::patch);
  std::vector<Body> bodies;
  for (int k = 0; k < 10'000; ++k) {
    Body& body = bodies.emplace_back(model_yarn);
    const Vec3 shift(2.0 * (k % 20), 0.25 * (k / 20 % 20), 0.25 * (k / 400));  // some touch
    for (std::vector<Vec3>* points :
         {&body.surface.points, &body.axis.points, &body.start.surface.points, &body.end.surface.points})
      for (Vec3& p : *points) p += shift;
    for (yarn::EndFace* end : {&body.start, &body.end}) end->origin += shift;
  }
  Model model = loosened(model_of(bodies));
  ASSERT_EQ(model.parts.size(), 30'000U);
  const std::vector<FoundYarn> found = taken(model);
  EXPECT_TRUE(model.parts.empty());
  ASSERT_EQ(found.size(), 10'000U);
  expect_same(bodies_of(found), bodies);
}

}  // namespace
}  // namespace selvage::test
