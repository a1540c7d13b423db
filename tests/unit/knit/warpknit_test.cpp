// Lapping notation, and warp knits that cannot be.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "construction/build.h"
#include "formats/registry.h"
#include "knit/lapping.h"

namespace selvage::fabric {
namespace {

std::string lapping_error(std::string_view text) {
  const Result<Lapping> read = parse_lapping(text, {3, 10});
  return read ? std::string("none") : read.error().text + " at " + std::to_string(read.error().place.column);
}

TEST(Lapping, IsReadInEverySpelling) {
  const Lapping satin = {{1, 0}, {3, 4}};
  for (const char* text : {"1-0/3-4", "1-0/3-4//", "1-0 3-4", "1-0\t3-4 //", "1-0 / 3-4 / /"}) {
    const Result<Lapping> read = parse_lapping(text, {});
    ASSERT_TRUE(read) << text << ": " << read.error().text;
    EXPECT_EQ(*read, satin) << text;
  }
}

TEST(Lapping, FaultsAreSaidAtTheirColumn) {
  EXPECT_NE(lapping_error("1-0/1-2/").find("does not close"), std::string::npos);
  EXPECT_NE(lapping_error("1-0/1-2///").find("does not close"), std::string::npos);
  EXPECT_NE(lapping_error("1-0/1").find("at 15"), std::string::npos);
  EXPECT_NE(lapping_error("1-0/-2").find("at 14"), std::string::npos);
  EXPECT_NE(lapping_error("1-0//1-2").find("nothing may follow"), std::string::npos);
  EXPECT_NE(lapping_error("1-99999999999").find("at 12"), std::string::npos);
  EXPECT_NE(lapping_error("1-10000").find("counted from 0 to 9999"), std::string::npos);
  EXPECT_NE(lapping_error("").find("at 10"), std::string::npos);
  EXPECT_NE(lapping_error("1_0").find("at 11"), std::string::npos);
}

// Closed (c): the underlap that follows goes against the overlap, so that the loop's legs cross at its foot.
// Without a following underlap (a pillar: 1-0/0-1) it is open (o). Laid in: l.
char lap_at(const Lapping& lapping, std::size_t course) {
  const Overlap &overlap = lapping[course], &next = lapping[(course + 1) % lapping.size()];
  if (overlap.is_laid_in()) return 'l';
  return (next.from - overlap.to) * (overlap.to - overlap.from) < 0 ? 'c' : 'o';
}

// Overlap and underlap in opposite directions: closed.
TEST(Lapping, OpenAndClosedLaps) {
  const auto laps = [](std::string_view text) {
    const Lapping lapping = *parse_lapping(text, {});
    std::string letters;
    for (std::size_t i = 0; i < lapping.size(); ++i) letters += lap_at(lapping, i);
    return letters;
  };
  EXPECT_EQ(laps("1-0/1-2"), "cc");
  EXPECT_EQ(laps("0-1/2-1"), "oo");
  EXPECT_EQ(laps("1-0/0-1"), "oo");
  EXPECT_EQ(laps("1-0/1-0"), "cc");
  EXPECT_EQ(laps("0-0/3-3"), "ll");
  EXPECT_EQ(laps("1-0/1-2/2-3/2-1"), "coco");  // open on the way, closed where it turns
}

// `stitch open` keeps the needles and opens every lap.
TEST(Lapping, ClassicsOpenAndClosed) {
  for (const char* name : {"tricot", "cord", "satin", "velvet", "locknit", "queens-cord", "atlas"}) {
    const auto closed = classic_lappings(name, Warpknit::Stitch::closed),
               open = classic_lappings(name, Warpknit::Stitch::open);
    ASSERT_EQ(closed.size(), open.size()) << name;
    ASSERT_FALSE(closed.empty()) << name;
    for (std::size_t b = 0; b < closed.size(); ++b) {
      const Lapping one = *parse_lapping(closed[b], {}), other = *parse_lapping(open[b], {});
      ASSERT_EQ(one.size(), other.size()) << name;
      for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].needle(), other[i].needle()) << name;
        EXPECT_EQ(lap_at(other, i), 'o') << name;
      }
    }
  }
  EXPECT_TRUE(classic_lappings("jersey", Warpknit::Stitch::open).empty());
}

struct BuiltWarpKnit {
  Diagnostics diagnostics;
  std::optional<Fabric> fabric;
  std::optional<YarnBuilder> builder;

  explicit BuiltWarpKnit(const std::string& body, const std::string& after = {}) {
    const Source source = Source::from_memory(
        "fabric 1\nthread t\n  diameter 0.1\nend\nwarpknit\n" + body + "end\n" + after, "w.txt");
    fabric = formats::txt::descriptor().read_fabric(source, diagnostics);
    if (fabric && !diagnostics.has_errors()) builder = YarnBuilder::create(*fabric, {}, diagnostics);
  }
  [[nodiscard]] std::string message() const {
    return diagnostics.has_errors() ? to_string(*diagnostics.first_error()) : std::string();
  }
};

TEST(Warpknit, OneYarnAGuideAndBar) {
  const BuiltWarpKnit built("  bar t 1-0/1-2\n  bar t 1-0/3-4\n  wales 5 pitch 1\n  courses 4 pitch 1\n");
  ASSERT_TRUE(built.builder) << built.message();
  ASSERT_EQ(built.builder->count(), 10U);
  const Result<YarnPlan> plan = built.builder->plan(8);
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->name, "bar2_4");
  EXPECT_EQ(plan->role, Role::wale);
}

// The pitches that the messages name are the smallest ones.
TEST(Warpknit, SmallestPitches) {
  const auto with = [](const std::string& wales, const std::string& courses) {
    return BuiltWarpKnit("  bar t 1-0/1-2\n  wales 3 pitch " + wales + "\n  courses 3 pitch " + courses +
                         "\n")
        .message();
  };
  EXPECT_EQ(with("0.4", "0.45"), "");
  EXPECT_NE(with("0.39", "0.45").find("at least 0.4"), std::string::npos) << with("0.39", "0.45");
  EXPECT_NE(with("0.4", "0.43").find("at least 0.44"), std::string::npos) << with("0.4", "0.43");
  EXPECT_NE(with("0.39", "0.45").find("w.txt:5"), std::string::npos);
}

// Locknit of 40 denier at 14 wales and 20 courses a centimetre, as it is sold: 6.4 yarns lie within a course
// of two bars (2 x 1 + 4 + 0.4), so that they are pressed to 0.5 / 6.4 mm.
TEST(Warpknit, FibresComeCloserWhereALoopHasNoRoom) {
  std::string courses = "20/cm";
  const auto text = [&](const std::string& thread) {
    return "fabric 1\nthread f\n  denier 40\n" + thread +
           "end\nwarpknit locknit\n  thread f\n  wales 4 14/cm\n  courses 4 " + courses + "\nend\n";
  };
  const auto message = [&](const std::string& thread, const BuildOptions& options,
                           std::vector<YarnPlan>* plans, std::string* told) {
    Diagnostics diagnostics;
    const std::optional<Fabric> fabric =
        formats::txt::descriptor().read_fabric(Source::from_memory(text(thread), "w.txt"), diagnostics);
    const std::optional<YarnBuilder> builder = YarnBuilder::create(*fabric, options, diagnostics);
    for (std::size_t i = 0; builder && plans != nullptr && i < builder->count(); ++i)
      plans->push_back(std::move(*builder->plan(i)));
    if (told != nullptr && !diagnostics.messages().empty()) *told = to_string(diagnostics.messages().front());
    return diagnostics.has_errors() ? to_string(*diagnostics.first_error()) : std::string();
  };
  std::vector<YarnPlan> plans;
  std::string told;
  EXPECT_EQ(message("  material nylon\n", {}, &plans, &told), "");
  EXPECT_NE(told.find("w.txt:2:1: note: the warp knit has no room for thread 'f' as it is: it is pressed to "
                      "0.07812 mm, the packing of its fibres rises from 0.75 to 0.81"),
            std::string::npos)
      << told;
  ASSERT_EQ(plans.size(), 8U);
  for (const YarnPlan& plan : plans)
    EXPECT_NEAR(yarn::nominal_size(plan.spec.section).width, 0.5 / 6.4, 1e-9);
  BuildOptions published;
  published.as_published = true;
  EXPECT_NE(message("  material nylon\n", published, nullptr, nullptr).find("need at least 0.5206"),
            std::string::npos);
  // Denser than fibres lie, pi / (2 sqrt 3): the pitch that the message names is the smallest one.
  courses = "24/cm";
  const std::string dense = message("  material nylon\n", {}, nullptr, nullptr);
  const double diameter =
      2 * std::sqrt(40.0 / 9 / (1000 * std::numbers::pi * 1.14 * std::numbers::pi / std::sqrt(12.0)));
  const std::size_t at = dense.find("need at least ");
  ASSERT_NE(at, std::string::npos) << dense;
  EXPECT_NEAR(std::stod(dense.substr(at + 14)), 6.4 * diameter, 1e-6);
  EXPECT_NE(dense.find(", with their fibres as close as they go"), std::string::npos);
  courses = "pitch " + std::to_string(6.4 * diameter + 1e-6);
  EXPECT_EQ(message("  material nylon\n", {}, nullptr, nullptr), "");
  courses = "20/cm";
  // Fibres that are one, that lie as close as they can, or whose yarn has a size of its own, stay.
  for (const std::string thread : {"  density 0.9\n  filaments 1\n", "  density 0.9\n  packing 0.9\n",
                                   "  material nylon\n  diameter 0.0814\n"})
    EXPECT_NE(message(thread, {}, nullptr, nullptr).find("too small for yarns"), std::string::npos) << thread;
}

TEST(Warpknit, WhatCannotBeIsSaidAtItsPlace) {
  const std::string size = "  wales 3 pitch 1\n  courses 3 pitch 1\n";
  EXPECT_NE(BuiltWarpKnit("  bar t 1-0/1-3\n" + size)
                .message()
                .find("w.txt:6:9: error: overlap 2 of this lapping, 1-3, goes over 2"),
            std::string::npos)
      << BuiltWarpKnit("  bar t 1-0/1-3\n" + size).message();
  EXPECT_NE(BuiltWarpKnit("  bar t 0-0/2-2\n" + size).message().find("no bar of this warp knit forms loops"),
            std::string::npos);
  EXPECT_NE(BuiltWarpKnit("  bar t 1-0/1-2 fall-plate\n" + size).message().find("forms loops"),
            std::string::npos);
  EXPECT_NE(BuiltWarpKnit("  bar t 1-0/1-2/\n" + size).message().find("does not close"), std::string::npos);
  EXPECT_NE(
      BuiltWarpKnit("  bar t 1-0/1-2\n  wales -3 pitch 1\n  courses 3 pitch 1\n").message().find("w.txt:7:9"),
      std::string::npos);
  const BuiltWarpKnit held("  bar t 1-0/1-1/1-1/1-1/1-1/1-1/1-1/1-1/1-1/1-1\n" + size);
  ASSERT_TRUE(held.builder);
  EXPECT_FALSE(held.builder->plan(0).ok());
}

TEST(Warpknit, AbsurdSizesAreRefusedBeforeTheyAreBuilt) {
  const std::string message =
      BuiltWarpKnit("  bar t 1-0/1-2\n  wales 1000000000 pitch 1\n  courses 1000000000 pitch 1\n").message();
  EXPECT_NE(message.find("data points"), std::string::npos) << message;
}

// With a unit cell the yarns go on by more than a pitch on both sides, and are the same within.
TEST(Warpknit, CellContinuesTheYarns) {
  const std::string body = "  bar t 1-0/1-2\n  wales 3 pitch 1\n  courses 4 pitch 1\n";
  const BuiltWarpKnit plain(body), cut(body, "cell 1 0 -1  3 2 1\nend\n");
  ASSERT_TRUE(plain.builder && cut.builder) << cut.message();
  const std::vector<Vec3> a = plain.builder->plan(1)->points, b = cut.builder->plan(1)->points;
  EXPECT_LE(b.front().y(), a.front().y() - 1.0);
  EXPECT_GE(b.back().y(), a.back().y() + 1.0);
  for (std::size_t i = 2; i + 2 < a.size(); ++i)
    EXPECT_NE(std::find(b.begin(), b.end(), a[i]), b.end()) << "data point " << i;
}

// Yarns that are the same but for their place get the same rows. (Beside a node of the frames a chord of the
// size of rounding turned the section over: two of these three had 318 rows instead of 112, down to one ulp
// from each other.)
TEST(Warpknit, EqualYarnsHaveEqualRows) {
  Diagnostics diagnostics;
  const Source source = Source::from_memory(
      "fabric 1\ntolerance 0.00139097\nthread t\n  section circle 0.217\nend\nwarpknit satin\n  thread t\n"
      "  stitch open\n  wales 3 pitch 1.3048\n  courses 2 pitch 2.08768\nend\n",
      "w.txt");
  const std::optional<Fabric> fabric = formats::txt::descriptor().read_fabric(source, diagnostics);
  ASSERT_TRUE(fabric);
  const auto builder = YarnBuilder::create(*fabric, {}, diagnostics);
  ASSERT_TRUE(builder);
  ASSERT_EQ(builder->count(), 3U);
  const std::vector<double> first = builder->build(0)->surface.knots_v;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::vector<double> knots = builder->build(i)->surface.knots_v;
    EXPECT_EQ(knots.size(), first.size());
    for (std::size_t k = 0; k + 1 < knots.size(); ++k)
      EXPECT_TRUE(knots[k + 1] == knots[k] || knots[k + 1] - knots[k] > 1e-6) << k;
  }
}

}  // namespace
}  // namespace selvage::fabric
