// Centre lines that are moved apart: on lines whose answer is known, and what the solver itself is built of
// against what it stands for.
#include "knit/mend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "knit/knit_mend.h"
#include "knit/mend_touch.h"
#include "nurbs/interpolate.h"
#include "nurbs/measure.h"

namespace selvage::fabric {
namespace {

constexpr auto uniform_parameters = nurbs::Parameterization::uniform;

nurbs::Curve through(const std::vector<Vec3>& points, nurbs::Parameterization how) {
  const std::vector<double> t = nurbs::parameters(points, how);
  return nurbs::interpolate(points, t, nurbs::end_derivative(points, t, false),
                            nurbs::end_derivative(points, t, true));
}

// A line whose points are classes of their own from `first` on.
MendLine line_through(const std::vector<Vec3>& points, int first) {
  MendLine line;
  line.points = points;
  for (std::size_t i = 0; i < points.size(); ++i) line.classes.push_back(first + static_cast<int>(i));
  line.curve = [](const std::vector<Vec3>& p) { return through(p, uniform_parameters); };
  line.shares = [](const std::vector<Vec3>& p) {
    return interpolation_shares(nurbs::parameters(p, uniform_parameters));
  };
  return line;
}

std::vector<Vec3> straight_points(const Vec3& from, const Vec3& to, int count) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) points.emplace_back(from + (to - from) * i / (count - 1));
  return points;
}

// The least distance of two lines after their moves, by dense sampling.
double least_distance(const MendLine& a, const MendLine& b, const Mending& mending) {
  const auto moved = [&](const MendLine& line) {
    std::vector<Vec3> points = line.points;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (line.classes[i] >= 0) points[i] += mending.moves[static_cast<std::size_t>(line.classes[i])];
    return line.curve(points);
  };
  const nurbs::Curve first = moved(a), second = moved(b);
  constexpr int looks = 1500;
  std::vector<Vec3> others;
  for (int i = 0; i <= looks; ++i) others.push_back(nurbs::evaluate(second, static_cast<double>(i) / looks));
  double least = 1e9;
  for (int i = 0; i <= looks; ++i) {
    const Vec3 p = nurbs::evaluate(first, static_cast<double>(i) / looks);
    for (const Vec3& q : others) least = std::min(least, (p - q).norm());
  }
  return least;
}

double missing_before(MendProblem problem) {
  problem.max_steps = 0;
  return mend(problem).missing;
}

TEST(Mend, TwoCrossingLinesPartByHalfOfTheLackEach) {
  MendProblem problem;
  problem.lines = {line_through(straight_points({-10, 0, 0.8}, {10, 0, 0.8}, 9), 0),
                   line_through(straight_points({0, -10, -0.8}, {0, 10, -0.8}, 9), 9)};
  problem.freedom.assign(18, Vec3::Ones());
  const Mending mending = mend(problem);
  EXPECT_TRUE(mending.is_solved());
  EXPECT_NEAR(missing_before(problem), 0.4, 1e-9);
  EXPECT_GE(least_distance(problem.lines[0], problem.lines[1], mending), 2.0);
  EXPECT_LT(least_distance(problem.lines[0], problem.lines[1], mending), 2.02);
  EXPECT_NEAR(mending.moves[4].z(), 0.2, 0.02);
  EXPECT_NEAR(mending.moves[4].z(), -mending.moves[13].z(), 1e-9);
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_NEAR(mending.moves[i].y(), 0, 1e-9);
    EXPECT_NEAR(mending.moves[i].z(), mending.moves[8 - i].z(), 1e-9);  // symmetric as the lines are
  }
}

TEST(Mend, WhatIsApartStaysToTheLastBit) {
  MendProblem problem;
  problem.lines = {line_through(straight_points({-10, 0, 1.01}, {10, 0, 1.01}, 5), 0),
                   line_through(straight_points({0, -10, -1.01}, {0, 10, -1.01}, 5), 5)};
  problem.freedom.assign(10, Vec3::Ones());
  const Mending mending = mend(problem);
  EXPECT_TRUE(mending.is_solved());
  EXPECT_EQ(missing_before(problem), 0);
  for (const Vec3& move : mending.moves) EXPECT_EQ(move, Vec3(0, 0, 0));
}

TEST(Mend, PointsAndCoordinatesThatAreHeldStay) {
  MendProblem problem;
  problem.lines = {line_through(straight_points({-10, 0, 0.8}, {10, 0, 0.8}, 9), 0),
                   line_through(straight_points({0, -10, -0.8}, {0, 10, -0.8}, 9), 9)};
  problem.lines[0].classes.assign(9, -1);
  problem.freedom.assign(18, Vec3(1, 0, 1));
  const Mending mending = mend(problem);
  EXPECT_TRUE(mending.is_solved());
  EXPECT_GE(least_distance(problem.lines[0], problem.lines[1], mending), 2.0);
  EXPECT_NEAR(mending.moves[13].z(), -0.4, 0.02);
  for (const Vec3& move : mending.moves) EXPECT_EQ(move.y(), 0);
}

TEST(Mend, WhatCannotMoveIsReportedWithWhatIsMissing) {
  MendProblem problem;
  problem.lines = {line_through(straight_points({-10, 0, 0.8}, {10, 0, 0.8}, 9), 0),
                   line_through(straight_points({0, -10, -0.8}, {0, 10, -0.8}, 9), 9)};
  for (MendLine& line : problem.lines) line.classes.assign(9, -1);
  const Mending mending = mend(problem);
  EXPECT_FALSE(mending.is_solved());
  EXPECT_NEAR(mending.missing, 0.4, 1e-9);
  EXPECT_LT(mending.at.norm(), 1e-6);
}

// A line that comes back to itself.
TEST(Mend, ALineIsPartedFromItself) {
  std::vector<Vec3> points;
  for (int i = 0; i <= 16; ++i) {  // a loop of a helix that is flatter than the yarn is thick
    const double a = 2 * 3.14159265358979 * i / 8;
    points.emplace_back(4 * std::cos(a), 4 * std::sin(a), 1.6 * i / 8);
  }
  MendProblem problem;
  problem.lines = {line_through(points, 0)};
  problem.freedom.assign(17, Vec3::Ones());
  const Mending mending = mend(problem);
  EXPECT_NEAR(missing_before(problem), 0.4, 0.05);
  EXPECT_TRUE(mending.is_solved());
  for (std::size_t i = 0; i < points.size(); ++i) points[i] += mending.moves[i];
  const nurbs::Curve curve = through(points, uniform_parameters);
  double least = 1e9;
  for (int i = 0; i <= 2000; ++i)
    for (int j = i + 500; j <= 2000; ++j)  // half a turn away
      least =
          std::min(least, (nurbs::evaluate(curve, i / 2000.0) - nurbs::evaluate(curve, j / 2000.0)).norm());
  EXPECT_GE(least, 2.0);
}

TEST(Mend, SharesAreTheDerivativesOfTheControlPoints) {
  std::vector<Vec3> points;
  for (int i = 0; i < 30; ++i)
    points.emplace_back(i + 0.3 * std::sin(i), std::cos(1.7 * i), std::sin(0.9 * i));
  const std::vector<double> t = nurbs::parameters(points, nurbs::Parameterization::chord);
  const auto control = [&](const std::vector<Vec3>& p) {
    return nurbs::interpolate(p, t, Vec3::UnitX(), Vec3::UnitY()).points;
  };
  const std::vector<Vec3> base = control(points);
  const std::vector<std::vector<Share>> shares = interpolation_shares(t);
  ASSERT_EQ(shares.size(), base.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<Vec3> moved = points;
    moved[i].z() += 1;
    const std::vector<Vec3> now = control(moved);
    for (std::size_t j = 0; j < now.size(); ++j) {
      double share = 0;
      for (const Share& s : shares[j])
        if (s.point == i) share = s.weight;
      EXPECT_NEAR(now[j].z() - base[j].z(), share, 2e-3) << i << " " << j;
    }
  }
}

TEST(Mend, PiecesAreTheCurve) {
  std::vector<Vec3> points;
  for (int i = 0; i < 12; ++i)
    points.emplace_back(i + 0.3 * std::sin(i), std::cos(1.7 * i), std::sin(0.9 * i));
  const nurbs::Curve curve = through(points, nurbs::Parameterization::centripetal);
  const CubicPath path(curve);
  ASSERT_EQ(path.spans(), points.size() - 1);
  for (int i = 0; i <= 110; ++i) {
    const double place = i / 10.0;
    const double t = path.parameter(place), h = path.step(path.span_of(place));
    const nurbs::CurveJet jet = nurbs::evaluate_jet(curve, t);
    EXPECT_LT((path.at(place).position - jet.position).norm(), 1e-12);
    EXPECT_LT((path.at(place).d1 - h * jet.d1).norm(), 1e-11);
    EXPECT_LT((path.at(place).d2 - h * h * jet.d2).norm(), 1e-9);
  }
}

// The nearest places of neighbouring cells are found exactly: two circles, linked.
TEST(Mend, TouchesAreNearestPlaces) {
  std::vector<Vec3> first, second;
  for (int i = 0; i <= 16; ++i) {
    const double a = 2 * 3.14159265358979 * i / 16;
    first.emplace_back(5 * std::cos(a), 5 * std::sin(a), 0);
    second.emplace_back(6.8 + 5 * std::cos(a), 0, 5 * std::sin(a));
  }
  MendProblem problem;
  problem.lines = {line_through(first, 0), line_through(second, 17)};
  const std::vector<CubicPath> paths = {CubicPath(through(first, uniform_parameters)),
                                        CubicPath(through(second, uniform_parameters))};
  const std::vector<Touch> touches = TouchFinder(problem, paths).find(paths, 1.5);
  ASSERT_FALSE(touches.empty());
  double least = 1e9;
  for (const Touch& touch : touches) {
    if (touch.line_a == touch.line_b) continue;  // where a ring's ends meet
    least = std::min(least, touch.slack + 2);
  }
  double sampled = 1e9;
  for (int i = 0; i <= 3200; ++i)
    for (int j = -40; j <= 40; ++j)
      sampled = std::min(sampled,
                         (paths[0].at(16.0 * i / 3200).position - paths[1].at(8 + 0.02 * j).position).norm());
  EXPECT_NEAR(least, sampled, 1e-4);
  EXPECT_LE(least, sampled + 1e-12);
}

// The periodic cubic through points and what follows them a period on.
nurbs::Curve periodic_through(const std::vector<Vec3>& points, const Vec3& period) {
  const std::vector<double> t = nurbs::parameters(points, uniform_parameters);
  // Long before and long after, so that the ends do not count.
  constexpr int copies = 6;
  std::vector<Vec3> all;
  for (int turn = -copies; turn <= copies; ++turn)
    for (std::size_t i = 0; i + 1 < points.size(); ++i) all.emplace_back(points[i] + turn * period);
  all.emplace_back(points.front() + (copies + 1) * period);
  return through(all, uniform_parameters);
}

std::vector<Vec3> wave_points() {
  std::vector<Vec3> points;
  for (int i = 0; i <= 8; ++i)
    points.emplace_back(i + 0.2 * std::sin(2.1 * (i % 8)), std::cos(1.7 * (i % 8)), std::sin(0.9 * (i % 8)));
  return points;
}
const Vec3 wave_period(8, 0, 0);

TEST(Mend, AKnitCourseGoesOnAsItsCopies) {
  const std::vector<Vec3> points = wave_points();
  const nurbs::Curve endless = periodic_through(points, wave_period);
  const CubicPath path(periodic_course(points, wave_period, uniform_parameters), wave_period);
  ASSERT_TRUE(path.is_periodic());
  ASSERT_EQ(path.spans(), 8U);
  constexpr int spans = 8 * 13;  // of the endless curve; the path's first one is its 48th
  for (int i = -160; i <= 240; ++i) {
    const double place = i / 10.0;
    const Vec3 expected = nurbs::evaluate(endless, (48 + place) / spans);
    EXPECT_LT((path.at(place).position - expected).norm(), 1e-9) << place;
  }
  // Of a course that is cut out of it, ends and all.
  std::vector<Vec3> cut = points;
  for (std::size_t i = 1; i < points.size(); ++i) cut.emplace_back(points[i] + wave_period);
  for (const auto how :
       {uniform_parameters, nurbs::Parameterization::chord, nurbs::Parameterization::centripetal}) {
    const nurbs::Curve line = course_line(cut, how, {8, wave_period}).curve;
    const CubicPath whole(periodic_course(points, wave_period, how), wave_period), part(line);
    ASSERT_EQ(part.spans(), 16U);
    for (int i = 0; i <= 160; ++i)
      EXPECT_LT((part.at(i / 10.0).position - whole.at(i / 10.0).position).norm(), 1e-12) << i;
  }
}

TEST(Mend, PeriodicSharesAreTheDerivativesOfTheControlPoints) {
  const std::vector<Vec3> points = wave_points();
  const auto control = [](std::vector<Vec3> p) {
    p.back() = p.front() + wave_period;
    return periodic_course(p, wave_period, uniform_parameters).points;
  };
  const std::vector<Vec3> base = control(points);
  const std::vector<std::vector<Share>> shares =
      periodic_shares(nurbs::parameters(points, uniform_parameters));
  ASSERT_EQ(shares.size(), base.size());
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    std::vector<Vec3> moved = points;
    moved[i].z() += 1;
    const std::vector<Vec3> now = control(moved);
    for (std::size_t j = 0; j < now.size(); ++j) {
      double share = 0;
      for (const Share& s : shares[j])
        if (s.point == i) share += s.weight;
      EXPECT_NEAR(now[j].z() - base[j].z(), share, 2e-3) << i << " " << j;
    }
  }
}

// An endless line over the copies of an endless line across it: one repeat is looked at, all of it is parted.
TEST(Mend, CopiesAreParted) {
  const auto across = [](const Vec3& from, const Vec3& period, int first) {
    MendLine line = line_through(straight_points(from, from + period, 9), first);
    line.classes.back() = first;
    line.period = period;
    line.curve = [period](const std::vector<Vec3>& p) {
      return periodic_course(p, period, uniform_parameters);
    };
    line.shares = [](const std::vector<Vec3>& p) {
      return periodic_shares(nurbs::parameters(p, uniform_parameters));
    };
    return line;
  };
  MendProblem problem;
  // They cross where no point of the first one's own repeat is, and copies stand beside them.
  problem.lines = {across({1, 3, 0.8}, {6, 0, 0}, 0), across({0, 0, -0.8}, {0, 6, 0}, 8)};
  problem.freedom.assign(16, Vec3::Ones());
  const Mending mending = mend(problem);
  ASSERT_TRUE(mending.is_solved());
  EXPECT_NEAR(missing_before(problem), 0.4, 1e-9);
  std::vector<CubicPath> paths;
  for (const MendLine& line : problem.lines) {
    std::vector<Vec3> points = line.points;
    for (std::size_t i = 0; i < points.size(); ++i)
      points[i] += mending.moves[static_cast<std::size_t>(line.classes[i])];
    paths.emplace_back(line.curve(points), line.period);
  }
  double least = 1e9;
  for (int i = -800; i <= 1600; ++i)
    for (int j = -400; j <= 800; ++j)
      least = std::min(least, (paths[0].at(i / 100.0).position - paths[1].at(j / 50.0).position).norm());
  EXPECT_GE(least, 2.0);
  EXPECT_LT(least, 2.02);
}

// A line between copies of itself that move like it has no room: that is told, and how much is missing.
TEST(Mend, CopiesThatMoveAlikeStayAsNearAsTheyAre) {
  MendProblem problem;
  problem.lines = {line_through(straight_points({-10, 0, 0}, {10, 0, 0}, 9), 0)};
  problem.freedom.assign(9, Vec3::Ones());
  problem.repeat = {0, 0, 1.7};
  const Mending mending = mend(problem);
  EXPECT_FALSE(mending.is_solved());
  EXPECT_NEAR(mending.missing, 0.3, 1e-3);
  problem.repeat = {0, 0, 2.1};
  EXPECT_TRUE(mend(problem).is_solved());
}

// The elastica: the wave of least bending for its length, by elliptic integrals of the
// modulus k (A. E. H. Love, Mathematical Theory of Elasticity, 1927, 262 f.): of a length L the period is
// L (2 E / K - 1), the integral of the squared curvature 64 K / L (E - (1 - k^2) K), and its height, from
// trough to crest, k L / K.
TEST(Mend, APeriodicLineRelaxesToTheElastica) {
  constexpr double period = 20;
  for (const double k : {0.3, 0.6, 0.75}) {
    const double complete_k = std::comp_ellint_1(k), complete_e = std::comp_ellint_2(k);
    const double length = period / (2 * complete_e / complete_k - 1);
    const double energy = 64 * complete_k / length * (complete_e - (1 - k * k) * complete_k);
    for (const int count : {16, 32}) {
      // A wave of that length, out of shape.
      const auto wave = [&](double height) {
        std::vector<Vec3> points;
        for (int i = 0; i <= count; ++i) {
          const double s = 2 * std::numbers::pi * i / count;
          points.emplace_back(period * i / count, height * (std::sin(s) + 0.1 * std::sin(3 * s)), 0);
        }
        return points;
      };
      const auto line_of = [&](const std::vector<Vec3>& p) {
        return periodic_course(p, {period, 0, 0}, uniform_parameters);
      };
      double low = 0, high = 4 * period;
      while (high - low > 1e-13 * period)
        (nurbs::arc_length(line_of(wave(0.5 * (low + high)))) < length ? low : high) = 0.5 * (low + high);
      MendProblem problem;
      MendLine line = line_through(wave(low), 0);
      line.classes.back() = 0;
      line.period = {period, 0, 0};
      line.radius = 0.4;
      line.keeps_length = true;
      line.curve = line_of;
      line.shares = [](const std::vector<Vec3>& p) {
        return periodic_shares(nurbs::parameters(p, uniform_parameters), least_relaxed_share);
      };
      problem.lines = {line};
      problem.freedom.assign(static_cast<std::size_t>(count), Vec3(1, 1, 0));
      problem.relaxes = true;
      const Mending mending = mend(problem);
      std::vector<Vec3> points = line.points;
      for (std::size_t i = 0; i < points.size(); ++i)
        points[i] += mending.moves[static_cast<std::size_t>(line.classes[i])];
      const nurbs::Curve relaxed = line_of(points);
      EXPECT_NEAR(nurbs::arc_length(relaxed), length, 1e-6 * length) << k;
      double bent = 0, bottom = 0, top = 0;
      constexpr int looks = 20000;
      for (int i = 0; i < looks; ++i) {
        const nurbs::CurveJet jet = nurbs::evaluate_jet(relaxed, (i + 0.5) / looks);
        bent += jet.d1.cross(jet.d2).squaredNorm() / std::pow(jet.d1.norm(), 5) / looks;
        bottom = std::min(bottom, jet.position.y());
        top = std::max(top, jet.position.y());
      }
      // Splines bend a little more than the best curve, by the fourth power of the distance of their points.
      const double spline = count == 16 ? 8e-3 : 1e-3;
      EXPECT_GT(bent, energy * (1 - 1e-5)) << k << " " << count;
      EXPECT_LT(bent, energy * (1 + spline)) << k << " " << count;
      EXPECT_NEAR(top - bottom, k * length / complete_k, 2e-3 * length) << k << " " << count;
    }
  }
}

}  // namespace
}  // namespace selvage::fabric
