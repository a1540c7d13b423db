// Surfaces that one cylinder, cone, sphere or torus carries, told from those that none does.
#include "cad/carrier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cad/compare.h"
#include "cad/natural_border.h"
#include "cad/sampled_curve.h"
#include "shapes.h"
#include "unit/cad/surfaces.h"

namespace selvage::cad {
namespace {

using nurbs::Surface;
using namespace test;

// A quarter circle's points and weights turned about z: radius and height of the profile's points.
struct Profile {
  std::vector<Vec3> points;  // (r, 0, z)
  std::vector<double> weights, knots;
  int degree = 1;
};

// Turned from one angle to another (radians, less than a half turn) in one rational piece: arcs that begin at
// other places have other parameters.
Surface turned(const Profile& profile, double from, double to) {
  Surface s;
  s.degree_u = 2;
  s.degree_v = profile.degree;
  s.count_u = 3;
  s.count_v = static_cast<int>(profile.points.size());
  s.knots_u = {0, 0, 0, 1, 1, 1};
  s.knots_v = profile.knots;
  const double half = 0.5 * (to - from), middle = 0.5 * (to + from);
  for (std::size_t j = 0; j < profile.points.size(); ++j) {
    const double r = profile.points[j].x(), z = profile.points[j].z();
    const double w = profile.weights.empty() ? 1 : profile.weights[j];
    for (const auto& [angle, reach, weight] :
         {std::tuple{from, 1.0, 1.0}, {middle, 1 / std::cos(half), std::cos(half)}, {to, 1.0, 1.0}}) {
      s.points.emplace_back(r * reach * std::cos(angle), r * reach * std::sin(angle), z);
      s.weights.push_back(w * weight);
    }
  }
  return s;
}

Profile segment(double r0, double z0, double r1, double z1) {
  return {{{r0, 0, z0}, {r1, 0, z1}}, {}, {0, 0, 1, 1}, 1};
}

// An arc about (c, 0) in the plane of r and z.
Profile profile_arc(double c, double radius, double from, double to) {
  const double half = 0.5 * (to - from), middle = 0.5 * (to + from), far = radius / std::cos(half);
  return {{{c + radius * std::cos(from), 0, radius * std::sin(from)},
           {c + far * std::cos(middle), 0, far * std::sin(middle)},
           {c + radius * std::cos(to), 0, radius * std::sin(to)}},
          {1, std::cos(half), 1},
          {0, 0, 0, 1, 1, 1},
          2};
}

std::optional<double> between(const Surface& a, const Surface& b, double enough = 1e-7) {
  return carrier_distance(a, domain(a), b, domain(b), enough);
}

TEST(Carrier, OfCylindersConesSpheresAndTori) {
  for (const Profile& profile : {segment(2, 0, 2, 5), segment(1, 0, 3, 4), profile_arc(0, 2, -0.7, 1.1),
                                 profile_arc(5, 1, -0.4, 1.9)}) {
    const Surface a = turned(profile, 0, 2), b = turned(profile, -0.3, 2.2);
    const auto bound = between(a, b);
    ASSERT_TRUE(bound.has_value());
    EXPECT_LE(*bound, 1e-9);
  }
}

TEST(Carrier, OfAConeWithItsPoint) {
  const Profile cone = segment(0, 0, 2, 3);
  const auto bound = between(turned(cone, 0, 2), turned(cone, -0.3, 2.2), 1e-6);
  ASSERT_TRUE(bound.has_value());
  EXPECT_LE(*bound, 1e-6);
}

TEST(Carrier, NoneWhereTheyDiffer) {
  constexpr double change = 1e-5;
  const std::vector<std::pair<Profile, Profile>> pairs = {
      {segment(2, 0, 2, 5), segment(2 + change, 0, 2 + change, 5)},
      {segment(1, 0, 3, 4), segment(1, 0, 3 + change, 4)},
      {profile_arc(0, 2, -0.7, 1.1), profile_arc(0, 2 + change, -0.7, 1.1)},
      {profile_arc(5, 1, -0.4, 1.9), profile_arc(5, 1 + change, -0.4, 1.9)},
      {profile_arc(5, 1, -0.4, 1.9), profile_arc(5 + change, 1, -0.4, 1.9)}};
  for (const auto& [one, other] : pairs) {
    const Surface a = turned(one, 0, 2), b = turned(other, -0.3, 2.2);
    EXPECT_FALSE(between(a, b, 0.5 * change).has_value());
    // Where it is certified after all, the bound holds.
    if (const auto bound = between(a, b, 100 * change)) {
      EXPECT_GE(*bound, 0.5 * change);
    }
  }
}

TEST(Carrier, NoneOfFreeShapes) {
  EXPECT_FALSE(between(wavy_tube(), reseamed(wavy_tube(), 0.3)).has_value());
}

// A face on one surface with the sides of another one as its boundary, in space only.
Subject subject_of(const Surface& surface, const Surface& border) {
  Subject subject;
  subject.model.parts = {test::part_of("face", {surface})};
  Loop& loop = subject.model.parts[0].faces[0].loops.emplace_back();
  for (Edge& edge : natural_border(border, 1e-9).edges) {
    edge.flat = {};
    loop.edges.push_back(std::move(edge));
  }
  return subject;
}

Comparison compared_within(const Subject& a, const Subject& b, double tolerance) {
  CompareOptions options;
  options.tolerance = tolerance;
  return compare(a, b, options);
}

TEST(Carrier, FacesOnOneSurfaceAreEqualHoweverItsParametersRun) {
  for (const Profile& profile : {segment(2, 0, 2, 5), segment(1, 0, 3, 4), profile_arc(0, 2, -0.7, 1.1),
                                 profile_arc(5, 1, -0.4, 1.9)}) {
    const Surface border = turned(profile, 0.1, 1.9);
    const Comparison found = compared_within(subject_of(turned(profile, 0, 2), border),
                                             subject_of(swapped(turned(profile, -0.3, 2.2)), border), 1e-6);
    EXPECT_TRUE(found.differences.empty());
    EXPECT_EQ(found.uncertain, 0U);
    EXPECT_LE(found.largest, 1e-6);
  }
}

TEST(Carrier, AChangedRadiusIsToldByTwoNearBounds) {
  const Surface a = turned(segment(2, 0, 2, 5), 0, 2), b = turned(segment(2.001, 0, 2.001, 5), -0.3, 2.2);
  const Surface border = turned(segment(2, 0, 2, 5), 0.1, 1.9);
  const Comparison found = compared_within(subject_of(a, border), subject_of(b, border), 1e-6);
  ASSERT_EQ(found.differences.size(), 1U);
  const Reach& reach = found.differences[0].reach;
  EXPECT_LE(reach.at_least, 0.001 + 1e-9);
  EXPECT_GE(reach.at_least, 0.0009);
  EXPECT_GE(reach.at_most, 0.001 - 1e-9);
  EXPECT_LE(reach.at_most, 1.5 * 0.001);
}

TEST(Carrier, BothSidesOfOneOutlineAreTwoFaces) {
  // A sphere of two pieces, of which one or the other half belongs to the face.
  const Profile half = profile_arc(0, 2, -std::numbers::pi / 4, std::numbers::pi / 4);
  const Surface zone = turned(half, 0, 2);
  const auto part = [&](double u0, double u1, double v0, double v1) {
    Subject subject;
    subject.model.parts = {test::part_of("face", {zone})};
    Loop& loop = subject.model.parts[0].faces[0].loops.emplace_back();
    const std::vector<Vec3> corners = {{u0, v0, 0}, {u1, v0, 0}, {u1, v1, 0}, {u0, v1, 0}};
    for (std::size_t k = 0; k < 4; ++k) {
      Edge& edge = loop.edges.emplace_back();
      edge.flat = line(corners[k], corners[(k + 1) % 4]);
    }
    return subject;
  };
  // The whole with a hole, and the hole's filling with the whole's outline as a second loop, have one
  // outline.
  Subject ring = part(0.1, 0.9, 0.1, 0.9), other = ring;
  ring.model.parts[0].faces[0].loops.push_back(part(0.3, 0.7, 0.3, 0.7).model.parts[0].faces[0].loops[0]);
  EXPECT_TRUE(compared_within(ring, ring, 1e-9).differences.empty());
  const Comparison found = compared_within(ring, other, 1e-9);
  ASSERT_EQ(found.differences.size(), 1U);
  EXPECT_GT(found.differences[0].reach.at_least, 0.1);
}

}  // namespace
}  // namespace selvage::cad
