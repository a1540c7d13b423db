// Straight yarns in warp knits: what the lappings imply of who lies before whom, against the crossings of the
// built centre lines, seen along z.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "construction/build.h"
#include "formats/registry.h"
#include "knit/lapping.h"
#include "nurbs/measure.h"

namespace selvage::fabric {
namespace {

struct Inlaid {
  Diagnostics diagnostics;
  std::optional<Fabric> fabric;
  std::vector<YarnPlan> plans;

  explicit Inlaid(const std::string& bars, double wale = 1.4, double course = 1.6) {
    const std::string text =
        "fabric 1\nthread t\n diameter 0.12\nend\nthread w\n diameter 0.15\nend\nwarpknit\n" + bars +
        " wales 4 pitch " + std::to_string(wale) + "\n courses 5 pitch " + std::to_string(course) + "\nend\n";
    fabric = formats::txt::descriptor().read_fabric(Source::from_memory(text, "w.txt"), diagnostics);
    if (!fabric || diagnostics.has_errors()) return;
    const std::optional<YarnBuilder> builder = YarnBuilder::create(*fabric, {}, diagnostics);
    for (std::size_t i = 0; builder && i < builder->count(); ++i) {
      plans.push_back(std::move(*builder->plan(i)));
      tell_from_origin(plans.back());
    }
  }
  [[nodiscard]] std::string message() const {
    return diagnostics.has_errors() ? to_string(*diagnostics.first_error()) : std::string();
  }
};

std::vector<Vec3> sampled(const YarnPlan& plan) {
  std::vector<Vec3> points;
  const nurbs::Curve& curve = plan.line.curve;
  constexpr int looks = 6000;
  for (int i = 0; i <= looks; ++i)
    points.push_back(nurbs::evaluate(
        curve, curve.first_parameter() + (curve.last_parameter() - curve.first_parameter()) * i / looks));
  return points;
}

struct Pass {
  double x = 0, height = 0;  // of the yarn over the straight one
};

// Where a yarn passes a line y = const, in its own order.
std::vector<Pass> passes(const YarnPlan& plan, double y, double z) {
  const std::vector<Vec3> p = sampled(plan);
  std::vector<Pass> found;
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    if ((p[i].y() < y) == (p[i + 1].y() < y)) continue;
    const double share = (y - p[i].y()) / (p[i + 1].y() - p[i].y());
    const Vec3 at = p[i] + share * (p[i + 1] - p[i]);
    found.push_back({at.x(), at.z() - z});
  }
  return found;
}

// Over each weft a yarn knits: both legs of that course's loop lie before it, on both sides of their needle,
// and the underlap to the next loop behind it. So it cannot leave the cloth either way.
TEST(InsertedWeft, LiesBehindLegsAndBeforeUnderlaps) {
  for (const std::string lappings : {"1-0/1-2", "0-1/2-1", "1-0/0-1", "1-0/2-3", "1-0/3-4", "1-0/1-2/2-3/2-1",
                                     "2-3/1-0,1-0/1-2", "1-0/1-2,1-0/0-1", "3-2/0-1,0-1/2-1"}) {
    std::string bars;
    std::vector<Lapping> all;
    for (std::size_t begin = 0; begin < lappings.size();) {
      const std::size_t end = std::min(lappings.find(',', begin), lappings.size());
      const std::string one = lappings.substr(begin, end - begin);
      bars += " bar t " + one + "\n";
      all.push_back(*parse_lapping(one, {}));
      begin = end + 1;
    }
    const Inlaid cloth(bars + " weft w every 1\n");
    ASSERT_EQ(cloth.plans.size(), 4 * all.size() + 5) << lappings << cloth.message();
    const double thickness = 0.5 * (0.12 + 0.15);
    for (std::size_t course = 0; course < 5; ++course) {
      const YarnPlan& weft = cloth.plans[4 * all.size() + course];
      EXPECT_EQ(weft.name, "weft_" + std::to_string(course + 1));
      EXPECT_EQ(weft.role, Role::weft);
      const std::vector<Vec3> line = sampled(weft);
      for (const Vec3& p : line) {  // straight
        ASSERT_NEAR(p.y(), line.front().y(), 1e-12);
        ASSERT_NEAR(p.z(), line.front().z(), 1e-12);
      }
      for (std::size_t yarn = 0; yarn < 4 * all.size(); ++yarn) {
        const Overlap& overlap = overlap_at(all[yarn / 4], static_cast<long long>(course));
        const double needle = 1.4 * (overlap.needle() - 0.5 + static_cast<double>(yarn % 4));
        const std::vector<Pass> found = passes(cloth.plans[yarn], line.front().y(), line.front().z());
        ASSERT_EQ(found.size(), 3U) << lappings << " " << cloth.plans[yarn].name << " " << course;
        const double side = overlap.from > overlap.to ? 1 : -1;
        EXPECT_GT(found[0].height, thickness) << lappings;
        EXPECT_GT(found[1].height, thickness) << lappings;
        EXPECT_LT(found[2].height, -thickness) << lappings;
        EXPECT_GT(side * (found[0].x - needle), 0) << lappings;
        EXPECT_LT(side * (found[1].x - needle), 0) << lappings;
        // It reaches from edge to edge, past all of them.
        for (const Pass& pass : found) {
          EXPECT_GT(pass.x, line.front().x());
          EXPECT_LT(pass.x, line.back().x());
        }
      }
    }
  }
}

TEST(InsertedWeft, StandsInTheCoursesThatAreAskedFor) {
  const auto heights = [](const std::string& weft) {
    const Inlaid cloth(" bar t 1-0/1-2\n " + weft + "\n");
    std::vector<double> all;
    for (const YarnPlan& plan : cloth.plans)
      if (plan.role == Role::weft) all.push_back(plan.points.front().y());
    return all;
  };
  const std::vector<double> every = heights("weft w every 1"), second = heights("weft w every 2 first 2");
  ASSERT_EQ(every.size(), 5U);
  ASSERT_EQ(second.size(), 2U);
  EXPECT_DOUBLE_EQ(second[0], every[1]);
  EXPECT_DOUBLE_EQ(second[1], every[3]);
  EXPECT_NEAR(every[1] - every[0], 1.6, 1e-12);
}

TEST(InsertedWeft, NeedsACourseAndRoom) {
  EXPECT_NE(
      Inlaid(" bar t 1-0/1-2\n weft w every 1 first 9\n").message().find("the first weft is in course 9"),
      std::string::npos);
  EXPECT_NE(Inlaid(" bar t 1-0/1-2\n weft x every 1\n").message().find("'x'"), std::string::npos);
  // One yarn more along a course, of the thickest.
  EXPECT_EQ(Inlaid(" bar t 1-0/1-2\n weft w every 1\n", 0.61, 0.811).message(), "");
  EXPECT_NE(Inlaid(" bar t 1-0/1-2\n weft w every 1\n", 0.61, 0.809).message().find("at least 0.81"),
            std::string::npos);
}

// A bar that stays in its space is a straight warp: before the underlaps of the bars before it, behind those
// of the bars behind it.
TEST(InsertedWeft, ABarThatStaysIsAStraightWarpBetweenUnderlaps) {
  const Inlaid cloth(" bar t 1-0/1-2\n bar w 1-1\n bar t 1-2/1-0\n", 1.8, 1.8);
  ASSERT_EQ(cloth.plans.size(), 12U) << cloth.message();
  for (std::size_t guide = 0; guide < 4; ++guide) {
    const std::vector<Vec3> warp = sampled(cloth.plans[4 + guide]);
    for (const Vec3& p : warp) {
      ASSERT_NEAR(p.x(), warp.front().x(), 0.02);  // moved by as little as it takes
      ASSERT_NEAR(p.z(), warp.front().z(), 0.02);
    }
    for (const std::size_t bar : {0U, 2U}) {
      int all = 0;
      for (std::size_t other = 0; other < 4; ++other) {
        const std::vector<Vec3> p = sampled(cloth.plans[4 * bar + other]);
        for (std::size_t i = 0; i + 1 < p.size(); ++i) {
          const double x = warp.front().x();
          if ((p[i].x() < x) == (p[i + 1].x() < x)) continue;
          if (p[i].y() < 0 || p[i].y() > 4 * 1.8) continue;
          ++all;
          const double height = p[i].z() - warp.front().z();
          EXPECT_GT(bar == 0 ? -height : height, 0.5 * (0.12 + 0.15)) << guide << " " << bar << " " << other;
        }
      }
      // In every course the underlaps of one guide cross a space that has needles on both sides.
      EXPECT_EQ(all, 4) << guide << " " << bar;
    }
  }
}

}  // namespace
}  // namespace selvage::fabric
