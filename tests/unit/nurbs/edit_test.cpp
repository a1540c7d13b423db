// Moved joints against the paper's closed formulas, brute force, and the bits of what must not change.
#include "nurbs/edit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <random>

#include "nurbs/interpolate.h"
#include "nurbs/measure.h"

namespace selvage::nurbs {
namespace {

bool same_bits(const Vec3& a, const Vec3& b) {
  return std::memcmp(a.data(), b.data(), sizeof(double) * 3) == 0;
}

std::vector<Vec3> random_points(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) points.emplace_back(1.5 * i + value(random), value(random), value(random));
  return points;
}

Curve uniform_unclamped(int count, bool rational) {
  Curve curve;
  curve.points = random_points(count, 11);
  for (int i = -3; i <= count; ++i) curve.knots.push_back(i);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> weight(0.4, 2.0);
  if (rational)
    for (int i = 0; i < count; ++i) curve.weights.push_back(weight(random));
  return curve;
}

Curve open_line(Parameterization how, int count = 9, bool rational = false) {
  const std::vector<Vec3> points = random_points(count, 5);
  const std::vector<double> t = parameters(points, how);
  Curve curve = interpolate(points, t, end_derivative(points, t, false), end_derivative(points, t, true));
  for (std::size_t i = 0; rational && i < curve.points.size(); ++i)
    curve.weights.push_back(1.0 + 0.3 * std::sin(2.0 * static_cast<double>(i)));
  return curve;
}

Curve ring(int count) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double a = 2.0 * std::numbers::pi * (i + 0.2 * std::sin(3.0 * i)) / count;
    points.emplace_back(2.0 * std::cos(a), 1.5 * std::sin(a), 0.3 * std::sin(2.0 * a));
  }
  return interpolate_closed(points, parameters(points, Parameterization::chord, true));
}

Vec3 joint_at(const Curve& curve, int joint) {
  return evaluate(curve, breakpoints(curve.knots, curve.degree)[static_cast<std::size_t>(joint - 1)]);
}

// Indices of the control points that differ in a bit (or in their weights).
std::vector<std::size_t> changed_points(const Curve& before, const Curve& after) {
  std::vector<std::size_t> changed;
  for (std::size_t i = 0; i < before.points.size(); ++i) {
    const double old_weight = before.is_rational() ? before.weights[i] : 1.0;
    const double new_weight = after.is_rational() ? after.weights[i] : 1.0;
    if (!same_bits(before.points[i], after.points[i]) || old_weight != new_weight) changed.push_back(i);
  }
  return changed;
}

// Segments (from 1) on which some point differs in a bit. A curve whose weights are all 1 where it did not
// change is compared with the same arithmetic: `before` gets such weights when `after` has some.
std::vector<int> changed_segments(Curve before, const Curve& after) {
  if (after.is_rational() && !before.is_rational()) before.weights.assign(before.points.size(), 1.0);
  const std::vector<double> breaks = breakpoints(before.knots, before.degree);
  std::vector<int> changed;
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    bool same = true;
    for (int i = 1; i < 20; ++i) {
      const double t = breaks[k] + (breaks[k + 1] - breaks[k]) * i / 20.0;
      same = same && same_bits(evaluate(before, t), evaluate(after, t));
    }
    if (!same) changed.push_back(static_cast<int>(k) + 1);
  }
  return changed;
}

TEST(MoveJointByControl, IsThePapersFormulaOnUniformKnots) {
  for (const bool rational : {false, true}) {
    const Curve curve = uniform_unclamped(12, rational);
    const auto w = [&](std::size_t i) { return rational ? curve.weights[i] : 1.0; };
    // Joint 5 is the knot 4, where the points 4, 5, 6 (from 0: knot i belongs to the point i + 1) count 1 : 4
    // : 1.
    const Vec3 p(4.0, 0.7, -0.3);
    const Result<Curve> moved = move_joint_by_control(curve, false, 5, p);
    ASSERT_TRUE(moved.ok()) << moved.error().text;
    const std::vector<std::size_t> expected = {5};
    EXPECT_EQ(changed_points(curve, *moved), expected);
    const Vec3 v1 = curve.points[4], v3 = curve.points[6];
    const Vec3 v2 = (w(4) * (p - v1) + 4.0 * w(5) * p + w(6) * (p - v3)) / (4.0 * w(5));
    EXPECT_LT((moved->points[5] - v2).norm(), 2e-14);
    EXPECT_LT((joint_at(*moved, 5) - p).norm(), 1e-14 * 10.0);
    EXPECT_EQ(changed_segments(curve, *moved), (std::vector<int>{3, 4, 5, 6}));
  }
}

TEST(MoveJointByControl, MeetsTheTargetAndTouchesOnePoint) {
  for (const auto how : {Parameterization::uniform, Parameterization::chord, Parameterization::centripetal})
    for (const bool rational : {false, true}) {
      const Curve curve = open_line(how, 9, rational);
      for (int joint = 1; joint <= 9; ++joint) {
        const Vec3 target = joint_at(curve, joint) + Vec3(0.3, -0.4, 1.1);
        const Result<Curve> moved = move_joint_by_control(curve, false, joint, target);
        ASSERT_TRUE(moved.ok());
        EXPECT_LT((joint_at(*moved, joint) - target).norm(), 1e-14 * 12.0) << joint;
        EXPECT_EQ(changed_points(curve, *moved).size(), 1U) << joint;
        EXPECT_LE(changed_segments(curve, *moved).size(), 4U);
        if (joint >= 4 && joint <= 6) {
          EXPECT_EQ(changed_segments(curve, *moved).size(), 4U);
        }
        EXPECT_EQ(moved->knots, curve.knots);
        EXPECT_EQ(moved->weights, curve.weights);
      }
    }
}

// Shares in joint 2 of a clamped uniform cubic are 1/4, 7/12, 1/6: the middle one is the largest.
TEST(MoveJointByControl, NextToAClampedEnd) {
  Curve curve;
  curve.points = random_points(8, 2);
  curve.knots = {0, 0, 0, 0, 1, 2, 3, 4, 5, 5, 5, 5};
  const Vec3 before = joint_at(curve, 2), step(0.0, 0.7, 0.0);
  const Result<Curve> moved = move_joint_by_control(curve, false, 2, before + step);
  ASSERT_TRUE(moved.ok());
  EXPECT_EQ(changed_points(curve, *moved), (std::vector<std::size_t>{2}));
  EXPECT_LT((moved->points[2] - curve.points[2] - 12.0 / 7.0 * step).norm(), 1e-14);
  const Result<Curve> end = move_joint_by_control(curve, false, 6, Vec3(9, 9, 9));
  ASSERT_TRUE(end.ok());
  EXPECT_EQ(changed_points(curve, *end), (std::vector<std::size_t>{7}));
  EXPECT_TRUE(same_bits(end->points.back(), Vec3(9, 9, 9)));
}

// Short segments before the joint, a long one behind it: the share of the first of the three points is 100 /
// 132.
TEST(MoveJointByControl, TakesThePointWithTheLargestShare) {
  Curve curve;
  curve.points = random_points(9, 4);
  curve.knots = {0, 0, 0, 0, 1, 2, 12, 13, 14, 15, 15, 15, 15};
  const Vec3 step(0.1, 0.7, 0.0);
  const Result<Curve> moved = move_joint_by_control(curve, false, 3, joint_at(curve, 3) + step);
  ASSERT_TRUE(moved.ok());
  EXPECT_EQ(changed_points(curve, *moved), (std::vector<std::size_t>{2}));
  EXPECT_LT((moved->points[2] - curve.points[2] - 1.32 * step).norm(), 1e-14);
}

Vec3 affine(const Vec3& p) {
  Eigen::Matrix3d m;
  m << 0.8, -0.3, 0.1, 0.2, 1.1, -0.4, 0.05, 0.3, 0.9;
  return m * p + Vec3(3, -2, 1);
}

TEST(MoveJoint, CommutesWithAffineMaps) {
  for (const bool closed : {false, true}) {
    const Curve curve = closed ? ring(7) : open_line(Parameterization::chord);
    Curve image = curve;
    for (Vec3& p : image.points) p = affine(p);
    for (int joint = 1; joint <= joint_count(curve, closed); ++joint) {
      const Vec3 here = joint_at(curve, joint), target = here + Vec3(0.2, 0.3, -0.1);
      const Result<Curve> a = move_joint_by_control(curve, closed, joint, target);
      const Result<Curve> b = move_joint_by_control(image, closed, joint, affine(target));
      ASSERT_TRUE(a.ok() && b.ok());
      for (std::size_t i = 0; i < a->points.size(); ++i)
        EXPECT_LT((affine(a->points[i]) - b->points[i]).norm(), 1e-13);
    }
  }
}

// --- closed

TEST(MoveJointOfARing, StaysC2AndChangesFourSegments) {
  const Curve curve = ring(9);
  for (int joint = 1; joint <= 9; ++joint) {
    const Vec3 target = joint_at(curve, joint) * 1.3 + Vec3(0, 0, 0.2);
    const Result<Curve> moved = move_joint_by_control(curve, true, joint, target);
    ASSERT_TRUE(moved.ok());
    EXPECT_LT((joint_at(*moved, joint) - target).norm(), 1e-14 * 3.0) << joint;
    EXPECT_TRUE(same_bits(moved->points.front(), moved->points.back()));
    const CurveJet first = evaluate_jet(*moved, 0.0), last = evaluate_jet(*moved, 1.0);
    EXPECT_LT((first.d1 - last.d1).norm(), 1e-12);
    EXPECT_LT((first.d2 - last.d2).norm(), 1e-10);
    std::vector<int> expected;
    for (int s = joint - 2; s <= joint + 1; ++s) expected.push_back((s + 8) % 9 + 1);
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(changed_segments(curve, *moved), expected) << joint;
  }
  EXPECT_FALSE(move_joint_by_control(curve, true, 10, Vec3::Zero()).ok());
}

TEST(MoveJointOfARing, ByWeightsAcrossTheSeam) {
  const Curve curve = ring(9);
  for (int joint = 1; joint <= 9; ++joint) {
    const Vec3 far = joint_at(curve, joint) * 0.97;
    const Result<Vec3> target = nearest_by_weight(curve, true, joint, far);
    ASSERT_TRUE(target.ok());
    const Result<Curve> moved = move_joint_by_weight(curve, true, joint, *target);
    ASSERT_TRUE(moved.ok()) << moved.error().text;
    EXPECT_GT((*target - joint_at(curve, joint)).norm(), 1e-3);
    EXPECT_LT((joint_at(*moved, joint) - *target).norm(), 1e-13) << joint;
    const CurveJet first = evaluate_jet(*moved, 0.0), last = evaluate_jet(*moved, 1.0);
    EXPECT_LT((first.d1 - last.d1).norm(), 1e-12);
    EXPECT_LT((first.d2 - last.d2).norm(), 1e-10);
    EXPECT_EQ(changed_segments(curve, *moved).size(), 6U);
  }
}

// --- by weight

struct Shares {
  Vec3 v[3];
  double w[3], b[3];
};

// The three points of a joint away from the ends: knot `joint` belongs to the point of the same index.
Shares shares_of(const Curve& curve, int joint) {
  Shares s;
  const std::vector<double> k(curve.knots.begin() + joint + 2 - 2, curve.knots.begin() + joint + 2 + 3);
  s.b[0] = (k[3] - k[2]) * (k[3] - k[2]) / ((k[3] - k[1]) * (k[3] - k[0]));
  s.b[2] = (k[2] - k[1]) * (k[2] - k[1]) / ((k[3] - k[1]) * (k[4] - k[1]));
  s.b[1] = 1.0 - s.b[0] - s.b[2];
  for (int i = 0; i < 3; ++i) {
    const auto row = static_cast<std::size_t>(joint - 1 + i);
    s.v[i] = curve.points[row];
    s.w[i] = curve.is_rational() ? curve.weights[row] : 1.0;
  }
  return s;
}

Vec3 blend(const Shares& s, double w0, double w1, double w2) {
  const double a = s.b[0] * w0, b = s.b[1] * w1, c = s.b[2] * w2;
  return (a * s.v[0] + b * s.v[1] + c * s.v[2]) / (a + b + c);
}

TEST(MoveJointByWeight, OneWeightOnItsLine) {
  for (const bool rational : {false, true}) {
    const Curve curve = open_line(Parameterization::chord, 9, rational);
    const Shares s = shares_of(curve, 5);
    ASSERT_LT((blend(s, s.w[0], s.w[1], s.w[2]) - joint_at(curve, 5)).norm(), 1e-14);
    for (int k = 0; k < 3; ++k)
      for (const double factor : {0.02, 0.5, 3.0, 50.0}) {
        std::array<double, 3> w = {s.w[0], s.w[1], s.w[2]};
        w[static_cast<std::size_t>(k)] *= factor;
        const Vec3 target = blend(s, w[0], w[1], w[2]);
        const Result<Curve> moved = move_joint_by_weight(curve, false, 5, target);
        ASSERT_TRUE(moved.ok()) << moved.error().text;
        const std::vector<std::size_t> expected = {static_cast<std::size_t>(4 + k)};
        EXPECT_EQ(changed_points(curve, *moved), expected);
        EXPECT_NEAR(moved->weights[expected[0]] / w[static_cast<std::size_t>(k)], 1.0, 1e-11);
        EXPECT_LT((joint_at(*moved, 5) - target).norm(), 1e-14 * 12.0);
        EXPECT_EQ(changed_segments(curve, *moved).size(), 4U);
        for (std::size_t i = 0; i < curve.points.size(); ++i)
          EXPECT_TRUE(same_bits(curve.points[i], moved->points[i]));
      }
  }
}

TEST(MoveJointByWeight, TwoWeightsInThePlaneAreThePapersDeterminants) {
  const Curve curve = uniform_unclamped(12, true);
  // In the plane z = 0 the paper's 2 x 2 determinants hold.
  Curve flat = curve;
  for (Vec3& p : flat.points) p.z() = 0.0;
  const Vec3 v1 = flat.points[4], v2 = flat.points[5], v3 = flat.points[6];
  const Vec3 p = 0.3 * v1 + 0.45 * v2 + 0.25 * v3;
  const Result<Curve> moved = move_joint_by_weight(flat, false, 5, p);
  ASSERT_TRUE(moved.ok()) << moved.error().text;
  const auto det = [](const Vec3& a, const Vec3& b) { return a.x() * b.y() - a.y() * b.x(); };
  const double w2 = flat.weights[5];
  const double w1 = det(p - v2, v3 - p) / det(v1 - p, v3 - p) * 4.0 * w2;
  const double w3 = det(v1 - p, p - v2) / det(v1 - p, v3 - p) * 4.0 * w2;
  EXPECT_NEAR(moved->weights[4] / w1, 1.0, 1e-13);
  EXPECT_NEAR(moved->weights[6] / w3, 1.0, 1e-13);
  EXPECT_EQ(changed_points(flat, *moved), (std::vector<std::size_t>{4, 6}));
  EXPECT_EQ(changed_segments(flat, *moved), (std::vector<int>{2, 3, 4, 5, 6, 7}));
  EXPECT_LT((joint_at(*moved, 5) - p).norm(), 1e-14 * 15.0);
}

TEST(MoveJointByWeight, NearestPointIsThatOfBruteForce) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> offset(-1.5, 1.5);
  for (const bool rational : {false, true}) {
    const Curve curve = open_line(Parameterization::centripetal, 9, rational);
    const Shares s = shares_of(curve, 4);
    int inside = 0, outside = 0;
    for (int trial = 0; trial < 40; ++trial) {
      const Vec3 target =
          (s.v[0] + s.v[1] + s.v[2]) / 3.0 + Vec3(offset(random), offset(random), offset(random));
      const Result<Vec3> nearest = nearest_by_weight(curve, false, 4, target);
      ASSERT_TRUE(nearest.ok());
      const double distance = (*nearest - target).norm();
      double best = 1e300;
      constexpr int steps = 400;
      for (int i = 0; i <= steps; ++i)
        for (int j = 0; j <= steps; ++j) {
          const double a = std::pow(1000.0, 2.0 * i / steps - 1.0),
                       c = std::pow(1000.0, 2.0 * j / steps - 1.0);
          best = std::min(best, (blend(s, a * s.w[1], s.w[1], c * s.w[1]) - target).norm());
        }
      EXPECT_LE(distance, best + 1e-12);  // nothing that can be reached is nearer
      EXPECT_GE(distance, best - 2e-3);   // and it is reached itself, up to the grid of the search
      const Result<Curve> moved = move_joint_by_weight(curve, false, 4, *nearest);
      ASSERT_TRUE(moved.ok()) << moved.error().text;
      EXPECT_LT((joint_at(*moved, 4) - *nearest).norm(), 1e-13 * 10.0);
      const double w1 = moved->weights[3] / moved->weights[4], w3 = moved->weights[5] / moved->weights[4];
      for (const double w : {w1, w3}) {
        EXPECT_GE(w, 1.0 / 1000.0 * (1.0 - 1e-9));
        EXPECT_LE(w, 1000.0 * (1.0 + 1e-9));
      }
      const bool is_inside = w1 > 0.00101 && w1 < 999.0 && w3 > 0.00101 && w3 < 999.0;
      ++(is_inside ? inside : outside);
    }
    EXPECT_GT(inside, 2);
    EXPECT_GT(outside, 2);
  }
}

TEST(MoveJointByWeight, SaysWhyATargetIsOutOfReach) {
  Curve curve;
  curve.points = {{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {3, 2, 0}, {4, 0, 0}, {5, 0, 0}, {6, 0, 0}};
  curve.knots = {0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4};
  const Vec3 middle = (curve.points[2] + curve.points[3] + curve.points[4]) / 3.0;
  const auto refusal = [&](int joint, const Vec3& target) {
    const Result<Curve> moved = move_joint_by_weight(curve, false, joint, target);
    return moved.ok() ? std::string("moved") : moved.error().text;
  };
  EXPECT_NE(refusal(3, middle + Vec3(0, 0, 0.25)).find("0.25 off the plane"), std::string::npos);
  EXPECT_NE(refusal(3, middle + Vec3(0, 0, 0.25)).find("nearest point that they reach is (3, 1, 0)"),
            std::string::npos)
      << refusal(3, middle + Vec3(0, 0, 0.25));
  EXPECT_NE(refusal(3, Vec3(3, 5, 0)).find("outside the triangle"), std::string::npos);
  EXPECT_NE(refusal(1, Vec3(3, 5, 0)).find("is where it is, (0, 0, 0)"), std::string::npos);
  EXPECT_NE(refusal(6, Vec3(3, 5, 0)).find("no joint 6"), std::string::npos);
  EXPECT_EQ(refusal(3, middle), "moved");
}

TEST(MoveJointByWeight, OnAStraightLine) {
  Curve curve;
  for (int i = 0; i < 7; ++i) curve.points.emplace_back(0.5 * i, 0, 0);
  curve.knots = {0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4};
  for (const double x : {1.01, 1.2, 1.5, 1.7, 1.99}) {
    const Result<Curve> moved = move_joint_by_weight(curve, false, 3, Vec3(x, 0, 0));
    ASSERT_TRUE(moved.ok()) << x << moved.error().text;
    EXPECT_NEAR(joint_at(*moved, 3).x(), x, 1e-14);
    for (double w : moved->weights) EXPECT_GT(w, 0.0);
  }
  EXPECT_FALSE(move_joint_by_weight(curve, false, 3, Vec3(2.2, 0, 0)).ok());
  const Result<Curve> off = move_joint_by_weight(curve, false, 3, Vec3(1.5, 0.3, 0));
  ASSERT_FALSE(off.ok());
  EXPECT_NE(off.error().text.find("in one line"), std::string::npos);
  EXPECT_NE(off.error().text.find("(1.5, 0, 0)"), std::string::npos) << off.error().text;
}

// --- to a length

TEST(MoveJointToLength, HasTheLength) {
  for (const bool closed : {false, true})
    for (const bool rational : {false, true}) {
      if (closed && rational) continue;
      const Curve curve = closed ? ring(8) : open_line(Parameterization::chord, 9, rational);
      const double present = arc_length(curve);
      for (int joint = 1; joint <= joint_count(curve, closed); ++joint)
        for (const double factor : {1.0001, 1.1, 7.0}) {
          const Vec3 along(0.3, 0.2, 1.0);
          const Result<Curve> moved = move_joint_to_length(curve, closed, joint, factor * present, along);
          ASSERT_TRUE(moved.ok()) << moved.error().text;
          EXPECT_NEAR(arc_length(*moved) / (factor * present), 1.0, 1e-11);
          const Vec3 move = joint_at(*moved, joint) - joint_at(curve, joint);
          EXPECT_GT(move.dot(along), 0.0);
          EXPECT_LT(move.cross(along).norm(), 1e-12 * (1.0 + move.norm()));
          if (!closed) {
            EXPECT_EQ(changed_points(curve, *moved).size(), 1U);
          }
        }
    }
}

TEST(MoveJointToLength, ShortensOnlyTheWayThatShortens) {
  // A bump: its joint 3 stands at the top of it.
  Curve curve;
  curve.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 2}, {4, 0, 0}, {5, 0, 0}, {6, 0, 0}};
  curve.knots = {0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4};
  const double present = arc_length(curve);
  ASSERT_GT(present, 6.5);
  const Result<Curve> shorter = move_joint_to_length(curve, false, 3, 6.2, Vec3(0, 0, -1));
  ASSERT_TRUE(shorter.ok()) << shorter.error().text;
  EXPECT_NEAR(arc_length(*shorter), 6.2, 1e-11);
  EXPECT_GT(shorter->points[3].z(), 0.0);  // the nearer of the two solutions, not the bump's mirror image
  // Straight is the shortest, 6: there the point has come down by 2.
  const Result<Curve> least = move_joint_to_length(curve, false, 3, 5.5, Vec3(0, 0, -1));
  ASSERT_FALSE(least.ok());
  EXPECT_NE(least.error().text.find("long at the shortest"), std::string::npos);
  EXPECT_NE(least.error().text.find("makes it 6 long"), std::string::npos) << least.error().text;
  const Result<Curve> wrong = move_joint_to_length(curve, false, 3, 6.2, Vec3(0, 0, 1));
  ASSERT_FALSE(wrong.ok());
  EXPECT_NE(wrong.error().text.find("the other way it can be 6 at the shortest"), std::string::npos)
      << wrong.error().text;
  // The length that it has: nothing changes.
  const Result<Curve> same = move_joint_to_length(curve, false, 3, present, Vec3(0, 0, 1));
  ASSERT_TRUE(same.ok());
  EXPECT_TRUE(changed_points(curve, *same).empty());
  EXPECT_FALSE(move_joint_to_length(curve, false, 3, 1e300, Vec3(0, 0, 1)).ok());
}

TEST(MoveJoint, RefusesArcsEnds) {
  Curve arc;  // a quarter circle and a straight
  arc.degree = 2;
  arc.points = {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {-1, 1, 0}, {-2, 1, 0}};
  arc.weights = {1, std::sqrt(0.5), 1, 1, 1};
  arc.knots = {0, 0, 0, 1, 1, 2, 2, 2};
  EXPECT_EQ(joint_count(arc, false), 3);
  for (const auto& moved :
       {move_joint_by_control(arc, false, 2, Vec3::Zero()), move_joint_by_weight(arc, false, 2, Vec3::Zero()),
        move_joint_to_length(arc, false, 2, 9.0, Vec3::UnitX())}) {
    ASSERT_FALSE(moved.ok());
    EXPECT_NE(moved.error().text.find("corner"), std::string::npos);
  }
}

}  // namespace
}  // namespace selvage::nurbs
