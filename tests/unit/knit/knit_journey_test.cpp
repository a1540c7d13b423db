// Charts that are the whole cloth: where loops go, and what each is drawn through, said by hand.
#include <gtest/gtest.h>

#include "construction/build.h"
#include "knit/journey.h"
#include "knit/knit.h"

namespace selvage::fabric {
namespace {

Knit charted(std::vector<std::string> top_first, std::vector<LoopMove> moves) {
  Knit knit;
  knit.form = Knit::Form::chart;
  knit.courses = static_cast<int>(top_first.size());
  knit.wales = static_cast<int>(top_first.front().size());
  knit.chart = std::move(top_first);
  knit.moves = std::move(moves);
  knit.chart_place = {3, 1};
  return knit;
}

StitchChart chart_of(const Knit& knit) {
  Result<StitchChart> chart = StitchChart::of(knit);
  EXPECT_TRUE(chart.ok()) << chart.error().text;
  return *chart;
}

LoopMove transfer(int row, int wale, int right) {
  return {{7, 2}, row, wale, right, false};
}

TEST(KnitJourney, ATransferMeetsALoopBehindIt) {
  const StitchChart chart = chart_of(charted({"KKK", "KKK"}, {transfer(1, 1, 1)}));
  const Journeys& ways = *chart.journeys();
  EXPECT_EQ(ways.at(0, 0).off, 1);
  EXPECT_EQ(ways.at(0, 0).right, 1);
  EXPECT_EQ(ways.at(0, 0).index, 1);
  EXPECT_EQ(ways.at(0, 1).index, 0);
  EXPECT_EQ(ways.at(0, 1).count, 2);
  EXPECT_EQ(ways.held(1, 0).count, 0);  // the eyelet
  EXPECT_EQ(ways.held(1, 1).count, 2);
  EXPECT_EQ(ways.held(1, 1).wale, 1);
  EXPECT_EQ(ways.at(1, 1).off, -1);
}

// A back loop is drawn through from the face: what lies foremost comes last on its needle.
TEST(KnitJourney, ThroughBackLoopsTheOrderTurns) {
  const StitchChart chart = chart_of(charted({"PPP", "PPP"}, {transfer(1, 1, 1)}));
  EXPECT_EQ(chart.journeys()->at(0, 0).index, 0);
  EXPECT_EQ(chart.journeys()->at(0, 1).index, 1);
}

TEST(KnitJourney, OfLoopsThatCrossTheFirstOneLiesBefore) {
  const StitchChart right = chart_of(charted({"KKKK", "KKKK"}, {transfer(1, 2, 1), transfer(1, 3, -1)}));
  EXPECT_EQ(right.journeys()->at(0, 1).lift, 1);
  EXPECT_EQ(right.journeys()->at(0, 2).lift, -1);
  EXPECT_EQ(right.journeys()->at(0, 0).lift, 0);
  const StitchChart left = chart_of(charted({"KKKK", "KKKK"}, {transfer(1, 3, -1), transfer(1, 2, 1)}));
  EXPECT_EQ(left.journeys()->at(0, 1).lift, -1);
  EXPECT_EQ(left.journeys()->at(0, 2).lift, 1);
}

TEST(KnitJourney, RowsEndWhereTheirYarnDoes) {
  const StitchChart chart = chart_of(charted({"KKKK", ".KM.", "..KK", "KKKK"}, {}));
  const Journeys& ways = *chart.journeys();
  EXPECT_EQ(ways.span(1).first, 2);
  EXPECT_EQ(ways.span(1).last, 3);
  EXPECT_EQ(ways.span(2).first, 1);
  EXPECT_EQ(ways.span(2).last, 2);
  EXPECT_EQ(ways.at(0, 0).off, 3);
  EXPECT_EQ(ways.at(0, 1).off, 2);
  EXPECT_EQ(ways.at(1, 2).off, 3);
  EXPECT_EQ(ways.longest_hold(), 2);
}

TEST(KnitJourney, ADroppedLoopIsDrawnThroughByNone) {
  const StitchChart chart = chart_of(charted({"KK", "KK"}, {{{7, 2}, 1, 2, 0, true}}));
  EXPECT_EQ(chart.journeys()->at(0, 1).off, -1);
  EXPECT_EQ(chart.journeys()->held(1, 1).count, 0);
}

TEST(KnitJourney, BedsHoldTheirOwnLoops) {
  Knit knit = charted({"KP", "PK", "KP"}, {transfer(1, 1, 0)});
  knit.gating = Knit::Gating::opposite;
  const StitchChart chart = chart_of(knit);
  EXPECT_EQ(chart.journeys()->at(0, 0).off, 2);
  EXPECT_EQ(chart.journeys()->at(1, 0).off, -1);
}

struct Wrong {
  std::string name;
  Knit knit;
  int line;
  std::string part;
};

TEST(KnitJourney, SaysWhatIsWrong) {
  Knit wider = charted({"KK.", "KKK"}, {});
  wider.wales = 6;
  const std::vector<std::string> held = {"KK", "K.", "K.", "K.", "K.", "K.", "K.", "K.", "KK"};
  for (const Wrong& wrong :
       {Wrong{"wider", wider, 3, "write 'courses 2' and 'wales 3'"},
        Wrong{"gap", charted({"K.K", "KKK"}, {}), 3, "'.' stands between stitches"},
        Wrong{"empty", charted({"...", "..."}, {}), 3, "no stitch"},
        Wrong{"held", charted(held, {}), 3, "wale 2 of the chart is held over more than 6"},
        Wrong{"row", charted({"KK"}, {transfer(2, 1, 1)}), 7, "there is no row 2, wale 1"},
        Wrong{"side", charted({"KK"}, {transfer(1, 1, -1)}), 7, "wale 0 is beyond the 2"},
        Wrong{"miss", charted({"MK"}, {transfer(1, 1, 1)}), 7, "it is M"},
        Wrong{"far", charted({"KK"}, {transfer(1, 1, 13)}), 7, "by 12 wales at most"},
        Wrong{"twice", charted({"KK"}, {transfer(1, 1, 1), transfer(1, 1, 1)}), 7, "moved twice"}}) {
    const Result<StitchChart> chart = StitchChart::of(wrong.knit);
    ASSERT_FALSE(chart.ok()) << wrong.name;
    EXPECT_NE(chart.error().text.find(wrong.part), std::string::npos) << chart.error().text;
    EXPECT_EQ(chart.error().place.line, wrong.line) << wrong.name;
  }
}

// A cloth goes on beyond its cell, and this one does not.
TEST(KnitJourney, HasNoCell) {
  Fabric fabric;
  Thread thread;
  thread.name = "t";
  thread.diameter = 0.2;
  fabric.threads = {thread};
  Knit knit = charted({"KK.", "KKK"}, {});
  knit.threads = {"t"};
  fabric.cell = Cell{};
  Diagnostics diagnostics;
  const Result<std::unique_ptr<Construction>> made = make_knit(fabric, knit, {}, diagnostics);
  ASSERT_FALSE(made.ok());
  EXPECT_NE(made.error().text.find("leave out the cell"), std::string::npos);
}

}  // namespace
}  // namespace selvage::fabric
