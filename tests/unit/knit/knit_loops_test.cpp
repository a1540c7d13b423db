// Loops of weft and warp knits that the user gives, by their unit or point by point, and loops that relax.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "construction/build.h"
#include "formats/registry.h"
#include "nurbs/measure.h"

namespace selvage::fabric {
namespace {

struct Cloth {
  Diagnostics diagnostics;
  std::optional<Fabric> fabric;
  std::vector<YarnPlan> plans;

  explicit Cloth(const std::string& block, const BuildOptions& options = {}) {
    const Source source = Source::from_memory("fabric 1\nthread t\n diameter 0.2\nend\n" + block, "k.txt");
    fabric = formats::txt::descriptor().read_fabric(source, diagnostics);
    if (!fabric || diagnostics.has_errors()) return;
    const std::optional<YarnBuilder> builder = YarnBuilder::create(*fabric, options, diagnostics);
    for (std::size_t i = 0; builder && i < builder->count(); ++i)
      if (Result<YarnPlan> plan = builder->plan(i); plan) plans.push_back(std::move(*plan));
  }
  [[nodiscard]] std::string message() const {
    return diagnostics.has_errors() ? to_string(*diagnostics.first_error()) : std::string();
  }
};

const BuildOptions published = [] {
  BuildOptions options;
  options.as_published = true;
  return options;
}();

// Table 1 of Chang et al., in units of the loop: wales 8, courses 7, both from the crossing B1.
const std::vector<Vec3> nine = {{-4, -3, -1.5}, {-1, 0, 0},    {-2, 3.5, 1.5}, {-3, 7, 0},   {0, 10, -1.5},
                                {3, 7, 0},      {2, 3.5, 1.5}, {1, 0, 0},      {4, -3, -1.5}};

// The paper's inputs: any crossing, any unit.
TEST(KnitLoops, TheUnitAndTheCrossingPlaceThePublishedPoints) {
  for (const double unit : {0.1, 0.13, 0.5}) {
    const Vec3 crossing(1.25, -0.5, 3);
    const Cloth cloth("knit jersey\n thread t\n courses 3\n wales 4\n unit " + std::to_string(unit) +
                          "\n crossing 1.25 -0.5 3\nend\n",
                      published);
    ASSERT_EQ(cloth.plans.size(), 3U) << cloth.message();
    for (std::size_t course = 0; course < 3; ++course) {
      const std::vector<Vec3>& points = cloth.plans[course].points;
      ASSERT_EQ(points.size(), 33U);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3 loop(8 * static_cast<double>(i / 8), 7 * static_cast<double>(course), 0);
        const Vec3 wanted = crossing + unit * (loop + nine[i % 8]);
        EXPECT_LT((points[i] - wanted).norm(), 1e-13) << unit << " " << course << " " << i;
      }
    }
  }
}

std::string rows(const std::vector<Vec3>& points) {
  std::string text;
  for (const Vec3& p : points)
    text += std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) + "\n";
  return text;
}

// Of one's own, in wales, courses and thicknesses of 2 r.
std::vector<Vec3> nine_own() {
  std::vector<Vec3> own;
  for (const Vec3& p : nine) own.emplace_back((p.x() + 4) / 8, p.y() / 7, p.z() / 2);
  return own;
}

TEST(KnitLoops, ThePublishedPointsAsOnesOwnAreThePublishedLoop) {
  const std::string size = "knit jersey\n thread t\n courses 4 pitch 0.9\n wales 5 pitch 1.1\n";
  for (const BuildOptions& options : {BuildOptions(), published}) {
    const Cloth own(size + " points\n" + rows(nine_own()) + " end\nend\n", options);
    const Cloth usual(size + "end\n", options);
    ASSERT_EQ(own.plans.size(), 4U) << own.message();
    for (std::size_t i = 0; i < 4; ++i) {
      ASSERT_EQ(own.plans[i].points.size(), usual.plans[i].points.size());
      // std::to_string has six digits.
      for (std::size_t k = 0; k < own.plans[i].points.size(); ++k)
        EXPECT_LT((own.plans[i].points[k] - usual.plans[i].points[k]).norm(), 2e-5) << i << " " << k;
    }
  }
}

TEST(KnitLoops, LoopsThatMakeNoClothAreRefused) {
  const std::string size = "knit jersey\n thread t\n courses 4\n wales 5\n";
  const auto message = [&](const std::vector<Vec3>& points, const std::string& knit) {
    return Cloth(knit + " points\n" + rows(points) + " end\nend\n").message();
  };
  EXPECT_EQ(message(nine_own(), size), "");
  std::vector<Vec3> open = nine_own();
  open.back().y() += 0.1;
  EXPECT_NE(message(open, size).find("k.txt:9:2: error: K does not close onto the K on its right"),
            std::string::npos)
      << message(open, size);
  // All before the loop below, or all behind it; drawn through from the other side; too low to reach it.
  for (const double z : {3.0, -3.0}) {
    std::vector<Vec3> flat = nine_own();
    for (Vec3& p : flat) p.z() = z * p.y();
    EXPECT_NE(message(flat, size).find("courses do not interloop"), std::string::npos) << z;
  }
  std::vector<Vec3> purl = nine_own();
  for (Vec3& p : purl) p.z() = -p.z();
  EXPECT_NE(message(purl, size).find("from the back to the face"), std::string::npos) << message(purl, size);
  std::vector<Vec3> low = nine_own();
  for (Vec3& p : low) p.y() *= 0.5;
  EXPECT_NE(message(low, size).find("courses do not interloop"), std::string::npos);
  EXPECT_NE(
      message(nine_own(), "knit purl\n thread t\n courses 4\n wales 5\n").find("add a block 'points P'"),
      std::string::npos);
  EXPECT_NE(message(nine_own(), size + " loop 4\n").find("leave out 'points'"), std::string::npos);
}

// The six points of a basic warp-knit loop (the paper prints no figures): the curve's control points are
// those of its construction, N = P -+ d |P P'| / 4, here written out.
TEST(KnitLoops, SixPointsOverALappingBecomeTenControlPoints) {
  const std::vector<Vec3> six = {{0.1, -0.15, -1.1}, {0.18, 0.5, 0.9},  {0.22, 1.25, 0.1},
                                 {-0.22, 1.25, 0.1}, {-0.18, 0.5, 0.9}, {-0.1, 0.1, -1.1}};
  const std::string text = "warpknit\n bar t 1-0/1-2\n points\n" + rows(six) +
                           " end\n wales 3 pitch 2\n courses 4 pitch 1.5\nend\n";
  const Cloth cloth(text, published);
  ASSERT_EQ(cloth.plans.size(), 3U) << cloth.message();
  const YarnPlan& plan = cloth.plans.front();
  const auto at = [&](std::size_t course, std::size_t i) {
    // 1-0 as given, on needle 1; 1-2 mirrored, on needle 2.
    const bool is_mirrored = course % 2 == 1;
    const double middle = (is_mirrored ? 1.5 : 0.5) * 2;
    return Vec3(middle + (is_mirrored ? -1 : 1) * 2 * six[i].x(),
                1.5 * (six[i].y() + static_cast<double>(course)), 0.2 * six[i].z());
  };
  // Two points lead to the first loop.
  std::size_t row = 2;
  for (std::size_t course = 0; course < 4; ++course)
    for (std::size_t i = 0; i < 6; ++i, ++row) {
      while ((plan.points[row] - at(course, i)).norm() > 1e-6 && row + 1 < plan.points.size())
        ++row;  // underlaps
      EXPECT_LT((plan.points[row] - at(course, i)).norm(), 1e-6) << course << " " << i;
      if (i == 0 || i == 5) continue;
      const Vec3 &before = plan.points[row - 1], &p = plan.points[row], &after = plan.points[row + 1];
      const Vec3 d = (after - before).normalized();
      EXPECT_LT((plan.line.curve.points[2 * row - 1] - (p - d * (p - before).norm() / 4)).norm(), 1e-12);
      EXPECT_LT((plan.line.curve.points[2 * row] - (p + d * (after - p).norm() / 4)).norm(), 1e-12);
    }
  std::vector<Vec3> low = six;
  for (Vec3& p : low) p.y() *= 0.6;
  const std::string refused = Cloth("warpknit\n bar t 1-0/1-2\n points\n" + rows(low) +
                                    " end\n wales 3 pitch 2\n courses 4 pitch 1.5\nend\n")
                                  .message();
  EXPECT_NE(refused.find("k.txt:7:2: error: courses do not interloop"), std::string::npos) << refused;
}

struct Bent {
  double energy = 0, length = 0;
};

// One loop in the middle of a cloth: the integral of the squared curvature, and the length.
Bent bent(const YarnPlan& plan, double from, double to) {
  Bent sum;
  const std::vector<double>& t = plan.line.parameters;
  constexpr int looks = 100000;
  const double step = (t.back() - t.front()) / looks;
  for (int i = 0; i < looks; ++i) {
    const nurbs::CurveJet jet = nurbs::evaluate_jet(plan.line.curve, t.front() + (i + 0.5) * step);
    if (jet.position.x() < from || jet.position.x() >= to) continue;
    const double speed = jet.d1.norm();
    sum.energy += step * jet.d1.cross(jet.d2).squaredNorm() / std::pow(speed, 5);
    sum.length += step * speed;
  }
  return sum;
}

// Loops that stand out of their wale are cut by planes x = const in several places, but in whole loops.
TEST(KnitLoops, RelaxedLoopsBendLeast) {
  for (const double loop : {3.6, 3.7, 4.2}) {
    const std::string size = "knit jersey\n thread t\n courses 5 pitch 0.7\n wales 8 pitch 0.95\n loop " +
                             std::to_string(loop) + "\n";
    const Cloth usual(size + "end\n"), relaxed(size + " shape relaxed\nend\n");
    ASSERT_EQ(relaxed.plans.size(), 5U) << relaxed.message();
    ASSERT_EQ(usual.plans.size(), 5U) << usual.message();
    const double from = 3 * 0.95, to = 5 * 0.95;
    const Bent before = bent(usual.plans[2], from, to), after = bent(relaxed.plans[2], from, to);
    EXPECT_LT(after.energy, 0.99 * before.energy) << loop;
    // The length, by the adaptive integral of the whole course.
    EXPECT_NEAR(nurbs::arc_length(relaxed.plans[2].line.curve), 8 * loop, 1e-6 * 8 * loop);
    // No overlap of a course with the next one, by dense sampling.
    const auto sampled = [](const YarnPlan& plan) {
      std::vector<Vec3> points;
      const std::vector<double>& t = plan.line.parameters;
      for (int i = 0; i <= 4000; ++i)
        points.push_back(plan.at +
                         nurbs::evaluate(plan.line.curve, t.front() + (t.back() - t.front()) * i / 4000));
      return points;
    };
    double nearest = 1e9;
    const std::vector<Vec3> low = sampled(relaxed.plans[2]), high = sampled(relaxed.plans[3]);
    for (const Vec3& p : low)
      for (const Vec3& q : high) nearest = std::min(nearest, (p - q).norm());
    EXPECT_GT(nearest, 0.2) << loop;
  }
}

// Loops with room are their own mirror image.
TEST(KnitLoops, RelaxedLoopsAreSymmetricWhereTheyHaveRoom) {
  const Cloth cloth(
      "knit jersey\n thread t\n courses 3 pitch 1\n wales 3 pitch 1.4\n loop 5.2\n shape relaxed\nend\n");
  ASSERT_EQ(cloth.plans.size(), 3U) << cloth.message();
  const std::vector<Vec3>& p = cloth.plans[1].points;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3& image = p[p.size() - 1 - i];
    EXPECT_LT((Vec3(3 * 1.4 - image.x(), image.y(), image.z()) - p[i]).norm(), 1e-6) << i;
  }
}

TEST(KnitLoops, LoopsWithoutRoomToRelaxAreToldSo) {
  const Cloth cloth(
      "knit jersey\n thread t\n courses 2 pitch 0.7\n wales 3 pitch 0.95\n loop 3.4\n shape relaxed\nend\n");
  ASSERT_EQ(cloth.plans.size(), 2U) << cloth.message();
  ASSERT_FALSE(cloth.diagnostics.messages().empty());
  EXPECT_NE(cloth.diagnostics.messages().front().text.find("no room to relax"), std::string::npos)
      << cloth.diagnostics.messages().front().text;
}

// Scaled as a whole, loops relax to the same shape: bending has no length of its own.
TEST(KnitLoops, RelaxedLoopsScale) {
  const auto built = [](double scale) {
    const Cloth cloth("units mm\nthread s\n diameter " + std::to_string(0.2 * scale) +
                      "\nend\nknit jersey\n thread s\n courses 3 pitch " + std::to_string(0.8 * scale) +
                      "\n wales 3 pitch " + std::to_string(1.1 * scale) + "\n loop " +
                      std::to_string(4.2 * scale) + "\n shape relaxed\nend\n");
    EXPECT_EQ(cloth.plans.size(), 3U) << cloth.message();
    return cloth.plans.empty() ? std::vector<Vec3>() : cloth.plans[1].points;
  };
  const std::vector<Vec3> one = built(1), eight = built(8);
  ASSERT_EQ(one.size(), eight.size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_LT((8 * one[i] - eight[i]).norm(), 8e-3) << i;
}

TEST(KnitLoops, WhatDoesNotRelaxIsSaid) {
  const auto message = [](const std::string& text) { return Cloth(text).message(); };
  EXPECT_NE(message("knit purl\n thread t\n courses 3\n wales 3\n shape relaxed\nend\n")
                .find("goes with 'knit jersey'"),
            std::string::npos);
  EXPECT_NE(message("knit jersey\n thread t\n courses 3\n wales 3\n shape relaxed\n method chord\nend\n")
                .find("uniform parameters"),
            std::string::npos);
  EXPECT_NE(message("knit jersey\n thread t\n courses 3\n wales 3\n shape relax\nend\n").find("relaxed"),
            std::string::npos);
  EXPECT_NE(message("knit jersey\n thread t\n courses 3 pitch 1\n wales 3\n unit 0.2\nend\n")
                .find("leave out 'unit'"),
            std::string::npos);
}

}  // namespace
}  // namespace selvage::fabric
