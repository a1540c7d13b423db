// Tubes against analytic volumes and against their own exact definition, sampled far more densely than the
// builder does.
#include "yarn/tube.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include "yarn/finish.h"
#include "yarn/frame.h"

namespace selvage::yarn {
namespace {

using std::numbers::pi;

Body make(const PathRows& rows, const TubeSpec& spec, EndStyle ends = EndStyle::patch) {
  Body body;
  body.name = "y";
  const Result<CentreLine> line = make_centre_line(rows);
  EXPECT_TRUE(line.ok());
  const Status swept = sweep(body, *line, spec);
  EXPECT_TRUE(swept.ok()) << (swept.ok() ? "" : to_string(swept.error()));
  const Status finished = finish(body, ends);
  EXPECT_TRUE(finished.ok()) << (finished.ok() ? "" : to_string(finished.error()));
  return body;
}

TubeSpec spec_of(const Section& section, const SectionSize& size, double tolerance) {
  TubeSpec spec;
  spec.section = section;
  spec.sizes = {{0.0, size, 0.0}};
  spec.tolerance = tolerance;
  return spec;
}

PathRows straight(double length) {
  PathRows rows;
  rows.points = {{0, 0, 0}, {length, 0, 0}};
  return rows;
}

PathRows ring(double radius, int points) {
  PathRows rows;
  rows.form = PathForm::uniform;
  rows.closed = true;
  for (int i = 0; i < points; ++i)
    rows.points.emplace_back(radius * std::cos(2 * pi * i / points), radius * std::sin(2 * pi * i / points),
                             0);
  return rows;
}

TEST(TubeTest, StraightTubeHasAreaTimesLength) {
  const std::vector<std::pair<Section, SectionSize>> exact = {{Circle{}, {1, 1}}, {Ellipse{}, {0.8, 0.2}}};
  for (const auto& [section, size] : exact)
    for (EndStyle ends : {EndStyle::patch, EndStyle::fan, EndStyle::planar, EndStyle::none}) {
      const Body body = make(straight(7), spec_of(section, size, 1e-3), ends);
      EXPECT_NEAR(body.volume, 7 * area(section, size), 1e-13 * 7);
      EXPECT_NEAR(body.end_area, area(section, size), 1e-14);
      EXPECT_NEAR(body.length, 7, 1e-13);
      EXPECT_FALSE(body.inward);
      EXPECT_EQ(body.surface.count_v, 4);  // no more sections than a straight line needs
      EXPECT_TRUE(body.tight_bends.empty());
    }
  for (const auto& [section, size] : std::vector<std::pair<Section, SectionSize>>{
           {Lenticular{}, {1.7, 0.14}}, {Racetrack{}, {1.4, 0.16}}}) {
    const Body body = make(straight(7), spec_of(section, size, 1e-5));
    const double rim = 2 * (size.width + size.height);
    EXPECT_NEAR(body.volume, 7 * area(section, size), 7 * rim * 1e-5);
  }
}

TEST(TubeTest, RingHasPappusVolume) {
  const Body body = make(ring(5, 8), spec_of(Circle{}, {1, 1}, 1e-5));
  // The centre line is the cubic through eight points, not the circle: Pappus with its own length, right to
  // the bend's second order; and the circle's volume to what eight points give.
  EXPECT_NEAR(body.volume, pi / 4 * body.length, 1e-5 * pi * body.length);
  EXPECT_NEAR(body.volume, pi / 4 * 2 * pi * 5, 2e-3 * body.volume);
  EXPECT_TRUE(body.closed_along);
  EXPECT_EQ(body.start.style, EndStyle::none);
  for (int i = 0; i < body.surface.count_u; ++i)
    EXPECT_EQ(body.surface.point(i, 0), body.surface.point(i, body.surface.count_v - 1));
  for (int j = 0; j < body.surface.count_v; ++j)
    EXPECT_EQ(body.surface.point(0, j), body.surface.point(body.surface.count_u - 1, j));
  EXPECT_LE(body.tube_error, 1e-5);
  // With many points the centre line is the circle.
  const Body fine = make(ring(5, 64), spec_of(Circle{}, {1, 1}, 1e-5));
  EXPECT_NEAR(fine.volume, pi / 4 * 2 * pi * 5, 1e-5 * fine.volume);
}

// The parameter near `t` at which `p` lies in the plane of the section.
double foot_of(const FrameField& frames, const Vec3& p, double t) {
  for (int i = 0; i < 8; ++i) {
    const Frame frame = frames.at(t);
    const Vec3 d = p - frame.position;
    t = std::clamp(t + d.dot(frame.tangent) / (frame.speed - d.dot(frame.tangent_dt)), 0.0, 1.0);
  }
  return t;
}

// The distance to the exact swept section by its definition: frames, sizes and outline evaluated directly. A
// section may slide along the sweep, which leaves its surface where it is.
double measured_error(const Body& body, const PathRows& rows, const TubeSpec& spec) {
  const Result<CentreLine> line = make_centre_line(rows);
  const Result<FrameField> frames = FrameField::make(line->curve, spec.guide, rows.closed);
  double largest = 0.0;
  const int along = 40 * body.surface.count_v, round = 40;
  for (int j = 0; j <= along; ++j) {
    const double w = spec.sizes.front().size.width / 2, h = spec.sizes.front().size.height / 2;
    for (int i = 0; i < round; ++i) {
      const Vec3 p = nurbs::evaluate(body.surface, (i + 0.37) / round, static_cast<double>(j) / along);
      const double t = foot_of(*frames, p, static_cast<double>(j) / along);
      const Frame frame = frames->at(t);
      const double angle = spec.twist * frames->length_at(t) + spec.sizes.front().angle;
      const Vec3 a = std::cos(angle) * frame.across + std::sin(angle) * frame.up, b = frame.tangent.cross(a);
      // The nearest point of the ellipse in the section plane, by scanning.
      const Vec3 d = p - frame.position;
      const double x = d.dot(a), y = d.dot(b);
      double s = std::atan2(y / h, x / w);  // of the ellipse's nearest point, by Newton's method
      for (int k = 0; k < 6; ++k) {
        const double c = std::cos(s), sine = std::sin(s);
        const double slope = (x - w * c) * w * sine - (y - h * sine) * h * c;
        s -= slope / (w * w * sine * sine + h * h * c * c + (x - w * c) * w * c + (y - h * sine) * h * sine);
      }
      largest =
          std::max(largest, Vec3(x - w * std::cos(s), y - h * std::sin(s), d.dot(frame.tangent)).norm());
    }
  }
  return largest;
}

TEST(TubeTest, DenseSamplingConfirmsTheReportedBound) {
  PathRows wave;
  wave.points = {{0, 0.5, 0.15}, {0.5, 0.5, 0}, {1, 0.5, -0.15}, {1.5, 0.5, 0}, {2, 0.5, 0.15}};
  wave.tangent_start = wave.tangent_end = Vec3(1, 0, 0);
  PathRows loop;
  loop.points = {{-4, -3, -1.5}, {-1, 0, 0},    {-2, 3.5, 1.5}, {-3, 7, 0},   {0, 10, -1.5},
                 {3, 7, 0},      {2, 3.5, 1.5}, {1, 0, 0},      {4, -3, -1.5}};
  struct Job {
    PathRows rows;
    TubeSpec spec;
  };
  std::vector<Job> jobs = {{wave, spec_of(Ellipse{}, {0.8, 0.2}, 2e-4)},
                           {wave, spec_of(Ellipse{}, {0.8, 0.2}, 2e-6)},
                           {loop, spec_of(Circle{}, {2, 2}, 2e-3)},
                           {loop, spec_of(Ellipse{}, {1.6, 0.9}, 1e-3)},
                           {ring(5, 8), spec_of(Circle{}, {1, 1}, 1e-5)}};
  jobs.push_back(jobs[3]);
  jobs.back().spec.twist = 2.0;  // radians per unit
  // Arcs of radius 2.1 and straights, along which sections slide.
  PathRows corners;
  corners.form = PathForm::polyline;
  corners.points = {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {10, 10, 10}, {20, 15, 10}};
  corners.half_sizes.assign(corners.points.size(), 2.0);
  jobs.push_back({corners, spec_of(Circle{}, {1, 1}, 1e-3)});
  jobs.push_back({corners, spec_of(Ellipse{}, {1.6, 0.9}, 1e-3)});
  // On a grid that is coarse beside the tolerance.
  jobs.push_back(jobs[2]);
  jobs.back().spec.grid = DecimalGrid(1e-4);
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    const Body body = make(jobs[k].rows, jobs[k].spec);
    const double measured = measured_error(body, jobs[k].rows, jobs[k].spec);
    EXPECT_LE(body.tube_error, jobs[k].spec.tolerance) << k;
    EXPECT_LE(measured, body.tube_error * (1 + 1e-9)) << k;
    EXPECT_GT(measured, 0.4 * body.tube_error) << k;  // the bound is worth its name
  }
}

// Where rows have sizes, the path and its sizes have knots at the same places: rounded, each is one double
// knot.
TEST(TubeTest, KnotsOfSizesAreThoseOfThePath) {
  PathRows rows;
  rows.form = PathForm::centripetal;
  rows.points = {{0, 0.74, 0.1}, {1.67, 0.9, -0.1}, {2.83, 0.9, 0.16}, {4.43, 0.84, 0.05}};
  const Result<CentreLine> line = make_centre_line(rows);
  ASSERT_TRUE(line.ok());
  for (const double tolerance : {2e-3, 3e-3, 5e-3, 7e-3, 9e-3}) {
    TubeSpec spec = spec_of(Ellipse{}, {0.48, 0.46}, tolerance);
    spec.grid = DecimalGrid(1e-6);
    spec.sizes.clear();
    for (std::size_t k = 0; k < line->parameters.size(); ++k)
      spec.sizes.push_back({line->parameters[k], {0.48 - 0.03 * static_cast<double>(k), 0.46}, 0.0});
    const Body body = make(rows, spec);
    const std::vector<double>& knots = body.surface.knots_v;
    for (std::size_t k = 4; k + 6 < knots.size(); ++k)
      EXPECT_GT(knots[k + 2], knots[k]) << tolerance << ' ' << k;
  }
}

// Every control point is a text of so many decimals, but for the rows at oblique ends, which stay flat.
TEST(TubeTest, ControlPointsStandOnTheGrid) {
  PathRows rows = ring(5, 8);
  rows.closed = false;
  rows.tangent_start = Vec3(0, 1, 0);
  TubeSpec spec = spec_of(Ellipse{}, {1.6, 0.9}, 1e-3);
  spec.grid = DecimalGrid(1e-7);
  const Body body = make(rows, spec);
  const auto has_decimals = [](double x) {
    char text[64];
    (void)std::snprintf(text, sizeof text, "%.7f", x);
    return std::strtod(text, nullptr) == x;
  };
  const nurbs::Surface& surface = body.surface;
  int free = 0;
  for (int j = 0; j < surface.count_v; ++j)
    for (int i = 0; i < surface.count_u; ++i) {
      const Vec3& p = surface.point(i, j);
      const bool is_short = has_decimals(p.x()) && has_decimals(p.y()) && has_decimals(p.z());
      if (j + 1 < surface.count_v)
        EXPECT_TRUE(is_short) << i << ' ' << j;
      else
        free += is_short ? 0 : 1;
    }
  EXPECT_GT(free, 0);
  const Vec3 normal = body.axis.points.back() - body.axis.points[body.axis.points.size() - 2];
  for (int i = 0; i < surface.count_u; ++i)
    EXPECT_NEAR((surface.point(i, surface.count_v - 1) - body.axis.points.back()).dot(normal.normalized()),
                0.0, 1e-14);
}

TEST(TubeTest, FinerTolerancesConvergeWithOrderFour) {
  PathRows wave;
  wave.points = {{0, 0, 0.3}, {1, 0, 0}, {2, 0, -0.3}, {3, 0, 0}, {4, 0, 0.3}};
  const Body coarse = make(wave, spec_of(Circle{}, {0.5, 0.5}, 1e-3)),
             fine = make(wave, spec_of(Circle{}, {0.5, 0.5}, 1e-7));
  // 10^4 finer: ten times the sections and points round for order four, with room for halving.
  EXPECT_LT(fine.surface.count_v, 40 * coarse.surface.count_v);
  EXPECT_LT(fine.surface.count_u, 16 * coarse.surface.count_u);
}

TEST(TubeTest, SizesFollowTheRowsWithoutOvershoot) {
  PathRows rows;
  rows.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  TubeSpec spec = spec_of(Ellipse{}, {1, 0.4}, 1e-5);
  spec.sizes = {
      {0.0, {1.0, 0.4}, 0}, {1.0 / 3, {1.0, 0.4}, 0}, {2.0 / 3, {0.6, 0.6}, 0}, {1.0, {0.6, 0.6}, 0}};
  const Body body = make(rows, spec);
  for (int k = 0; k < 4; ++k) {
    const double t = k / 3.0;
    const double w = spec.sizes[static_cast<std::size_t>(k)].size.width,
                 h = spec.sizes[static_cast<std::size_t>(k)].size.height;
    // across is +y for a path along x with up = z.
    EXPECT_NEAR(nurbs::evaluate(body.surface, 0.0, t).y(), w / 2, 2e-5);
    EXPECT_NEAR(nurbs::evaluate(body.surface, 0.25, t).z(), h / 2, 2e-5);
  }
  for (double t = 0; t <= 1; t += 0.01) {
    EXPECT_LE(nurbs::evaluate(body.surface, 0.0, t).y(), 0.5 + 2e-5);
    EXPECT_GE(nurbs::evaluate(body.surface, 0.0, t).y(), 0.3 - 2e-5);
  }
  spec.section = Lenticular{};
  const Body lens = make(rows, spec);
  EXPECT_LE(lens.tube_error, 1e-5);
  for (int k = 0; k < 4; ++k)
    EXPECT_NEAR(nurbs::evaluate(lens.surface, 0.25, k / 3.0).z(),
                spec.sizes[static_cast<std::size_t>(k)].size.height / 2, 2e-5);
}

TEST(TubeTest, TwistTurnsTheSectionRightHandedForZ) {
  TubeSpec spec = spec_of(Ellipse{}, {1, 0.4}, 1e-4);
  spec.twist = 2 * pi / 8;  // one turn in eight units, positive: Z
  const Body body = make(straight(8), spec);
  // A quarter turn further on, the section's x axis has gone from +y (across) to +z (up).
  EXPECT_LT((nurbs::evaluate(body.surface, 0.0, 0.0) - Vec3(0, 0.5, 0)).norm(), 2e-4);
  EXPECT_LT((nurbs::evaluate(body.surface, 0.0, 0.25) - Vec3(2, 0, 0.5)).norm(), 2e-4);
  EXPECT_NEAR(body.volume, 8 * pi / 4 * 0.4, 8 * 3 * 1e-4);
}

TEST(TubeTest, TooMuchTwistIsALimitErrorAtOnce) {
  Body body;
  body.name = "rope";
  const Result<CentreLine> line = make_centre_line(straight(8));
  TubeSpec spec = spec_of(Ellipse{}, {1, 0.4}, 1e-4);
  spec.twist = 1e12;
  spec.max_control_points = 1'000'000;
  const Status swept = sweep(body, *line, spec);
  ASSERT_FALSE(swept.ok());
  EXPECT_EQ(swept.error().kind, Kind::limit);
  EXPECT_NE(swept.error().text.find("rope"), std::string::npos);
}

TEST(TubeTest, ARigidMotionMovesTheSurface) {
  PathRows rows, moved;
  rows.points = {{0, 0, 0}, {1, 0.5, 0.2}, {2, -0.3, 0.5}, {3, 0, 0}};
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.8, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  const Vec3 shift(10, -4, 2);
  for (const Vec3& p : rows.points) moved.points.emplace_back(turn * p + shift);
  TubeSpec a = spec_of(Ellipse{}, {0.4, 0.2}, 1e-4), b = a;
  a.guide.direction = Vec3(0, 0.1, 1);
  b.guide.direction = Vec3(turn * *a.guide.direction);
  const Body one = make(rows, a), two = make(moved, b);
  ASSERT_EQ(one.surface.points.size(), two.surface.points.size());
  for (std::size_t i = 0; i < one.surface.points.size(); ++i)
    EXPECT_LT((turn * one.surface.points[i] + shift - two.surface.points[i]).norm(), 1e-10);
}

TEST(TubeTest, BendsTighterThanTheSectionAreFoundWhereTheyAre) {
  PathRows rows;
  rows.points = {{0, 0, 0}, {2, 0, 0}, {2.2, 0.1, 0}, {2.2, 0.4, 0}, {2, 0.5, 0}, {0, 0.5, 0}};
  const Body thick = make(rows, spec_of(Circle{}, {0.8, 0.8}, 1e-2));
  ASSERT_FALSE(thick.tight_bends.empty());
  const TightBend& bend = thick.tight_bends.front();
  EXPECT_LT(bend.radius, bend.needed);
  EXPECT_NEAR(bend.needed, 0.4, 0.02);
  EXPECT_NEAR(bend.at.x(), 2.2, 0.3);
  ASSERT_FALSE(thick.messages.empty());
  EXPECT_EQ(thick.messages.front().yarn, "y");
  const Body thin = make(rows, spec_of(Circle{}, {0.05, 0.05}, 1e-3));
  EXPECT_TRUE(thin.tight_bends.empty());
}

TEST(TubeTest, PolylineTubesKeepTheirTolerance) {
  PathRows rows;
  rows.form = PathForm::polyline;
  rows.points = {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {3, 3, 3}};
  rows.half_sizes.assign(4, 0.5);
  const TubeSpec spec = spec_of(Circle{}, {1, 1}, 1e-3);
  const Body body = make(rows, spec);
  EXPECT_LE(body.tube_error, 1e-3);
  EXPECT_LE(measured_error(body, rows, spec), body.tube_error * (1 + 1e-9));
  EXPECT_TRUE(body.tight_bends.empty());
  EXPECT_NEAR(body.volume, pi / 4 * body.length, 1e-3 * pi * body.length);  // Pappus
}

}  // namespace
}  // namespace selvage::yarn
