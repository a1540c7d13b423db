// The named drafts against what defines them: over and under counts, the shift from pick to pick, one
// crossing a row and column of a satin.
#include "weave/draft.h"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

namespace selvage::fabric {
namespace {

using Rows = std::vector<std::string>;

Draft named(Draft::Form form, int a = 0, int b = 0) {
  Draft draft;
  draft.form = form;
  draft.a = a;
  draft.b = b;
  return draft;
}

// Rows as Fabric TXT writes them, '1' where the warp is on top.
Rows rows_of(const Drawdown& drawdown) {
  Rows rows(static_cast<std::size_t>(drawdown.picks));
  for (int pick = 0; pick < drawdown.picks; ++pick)
    for (int end = 0; end < drawdown.ends; ++end)
      rows[static_cast<std::size_t>(pick)] += drawdown.warp_on_top(pick, end) ? '1' : '0';
  return rows;
}

Draft rows(Rows rows) {
  Draft draft;
  draft.form = Draft::Form::rows;
  draft.rows = std::move(rows);
  return draft;
}

Drawdown made_drawdown(const Draft& draft) {
  auto drawdown = drawdown_of(draft);
  if (!drawdown) ADD_FAILURE() << drawdown.error().text;
  return drawdown ? std::move(*drawdown) : Drawdown{1, 1, {false}};
}

TEST(Draft, PlainAndRowsAreTheirText) {
  EXPECT_EQ(rows_of(made_drawdown(named(Draft::Form::plain))), (Rows{"10", "01"}));
  const Rows oblong{"110", "001"};
  const Drawdown drawdown = made_drawdown(rows(oblong));
  EXPECT_EQ(drawdown.picks, 2);
  EXPECT_EQ(drawdown.ends, 3);
  EXPECT_EQ(rows_of(drawdown), oblong);
}

TEST(Draft, RepeatsBothWays) {
  const Drawdown drawdown = made_drawdown(rows({"110", "001"}));
  for (long long pick = -6; pick <= 6; ++pick)
    for (long long end = -9; end <= 9; ++end)
      EXPECT_EQ(drawdown.warp_on_top(pick, end), drawdown.warp_on_top(pick + 4, end - 6));
  EXPECT_TRUE(drawdown.warp_on_top(-1, -1));
  EXPECT_FALSE(drawdown.warp_on_top(-2, -1));
}

TEST(Draft, TwillGoesOverAAndUnderBAndRisesToTheRight) {
  EXPECT_EQ(rows_of(made_drawdown(named(Draft::Form::twill, 2, 1))), (Rows{"110", "101", "011"}));
  for (const auto& [a, b] : {std::pair{1, 1}, {2, 1}, {1, 2}, {2, 2}, {3, 1}, {5, 3}}) {
    const Drawdown drawdown = made_drawdown(named(Draft::Form::twill, a, b));
    ASSERT_EQ(drawdown.picks, a + b);
    ASSERT_EQ(drawdown.ends, a + b);
    for (int pick = 0; pick < a + b; ++pick) EXPECT_EQ(drawdown.warp_on_top(pick, 0), pick < a);  // warp 1
    // One row up and one column to the right is the same crossing: the diagonal "/" of a Z twill.
    for (int pick = 0; pick < a + b; ++pick)
      for (int end = 0; end < a + b; ++end)
        EXPECT_EQ(drawdown.warp_on_top(pick, end), drawdown.warp_on_top(pick - 1, end + 1)) << a << "/" << b;
  }
}

TEST(Draft, SatinHasOneWarpOnTopAPickAndAnEndAtItsStep) {
  EXPECT_EQ(rows_of(made_drawdown(named(Draft::Form::satin, 5, 2))),
            (Rows{"10000", "00010", "01000", "00001", "00100"}));
  for (int n = 2; n <= 16; ++n) {
    for (int step = 1; step <= n; ++step) {
      const auto satin = drawdown_of(named(Draft::Form::satin, n, step));
      ASSERT_EQ(satin.ok(), step > 1 && step < n - 1 && std::gcd(n, step) == 1) << n << "/" << step;
      if (!satin) continue;
      std::vector<int> per_end(static_cast<std::size_t>(n));
      for (int pick = 0; pick < n; ++pick) {
        int on_top = 0;
        for (int end = 0; end < n; ++end) {
          if (!satin->warp_on_top(pick, end)) continue;
          ++on_top;
          ++per_end[static_cast<std::size_t>(end)];
          EXPECT_TRUE(satin->warp_on_top(pick + 1, end - step));
        }
        EXPECT_EQ(on_top, 1);
      }
      EXPECT_EQ(per_end, std::vector<int>(static_cast<std::size_t>(n), 1));
    }
  }
}

TEST(Draft, BasketIsBlocks) {
  EXPECT_EQ(rows_of(made_drawdown(named(Draft::Form::basket, 2, 2))), (Rows{"1100", "1100", "0011", "0011"}));
  EXPECT_EQ(rows_of(made_drawdown(named(Draft::Form::basket, 2, 1))), (Rows{"110", "110", "001"}));
  EXPECT_EQ(made_drawdown(named(Draft::Form::basket, 1, 1)), made_drawdown(named(Draft::Form::plain)));
}

// A few numbers are no reason to fill millions of crossings.
TEST(Draft, ByNumbersIsOfFewShafts) {
  for (const auto form : {Draft::Form::twill, Draft::Form::basket, Draft::Form::satin}) {
    Draft draft;
    draft.form = form;
    draft.a = 900;
    draft.b = form == Draft::Form::satin ? 7 : 9000;
    const Result<Drawdown> drawdown = drawdown_of(draft);
    ASSERT_FALSE(drawdown);
    EXPECT_EQ(drawdown.error().kind, Kind::limit);
    draft.a = 250;
    draft.b = form == Draft::Form::satin ? 3 : 250;
    EXPECT_TRUE(drawdown_of(draft));
  }
}

TEST(Draft, RefusesWhatIsNoDraft) {
  const int huge = std::numeric_limits<int>::max();
  const std::vector<std::pair<Draft, Kind>> cases{{rows({}), Kind::malformed},
                                                  {rows({""}), Kind::malformed},
                                                  {rows({"10", "1"}), Kind::malformed},
                                                  {rows({"1x"}), Kind::malformed},
                                                  {named(Draft::Form::twill, 0, 2), Kind::malformed},
                                                  {named(Draft::Form::twill, 2, -1), Kind::malformed},
                                                  {named(Draft::Form::basket, 1, 0), Kind::malformed},
                                                  {named(Draft::Form::satin, -5, 2), Kind::malformed},
                                                  {named(Draft::Form::twill, huge, huge), Kind::limit},
                                                  {named(Draft::Form::satin, huge, 2), Kind::limit},
                                                  {named(Draft::Form::file), Kind::unsupported}};
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto drawdown = drawdown_of(cases[i].first);
    ASSERT_FALSE(drawdown.ok()) << "case " << i;
    EXPECT_EQ(drawdown.error().kind, cases[i].second) << "case " << i;
  }
}

TEST(Draft, WhatFallsApartIsTold) {
  const auto apart = [](const std::vector<std::string>& rows) {
    Draft draft;
    draft.form = Draft::Form::rows;
    draft.rows = rows;
    return what_falls_apart(drawdown_of(draft).value());
  };
  EXPECT_EQ(apart({"10", "01"}), "");
  EXPECT_EQ(apart({"110", "011", "101"}), "");
  EXPECT_EQ(apart({"1100", "1100", "0011", "0011"}), "");
  EXPECT_EQ(apart({"10", "01", "11"}), "weft 3 lies under every warp");
  EXPECT_EQ(apart({"100", "010"}), "warp 3 lies under every weft");
  // Two plain cloths, one on the other; and stitched, where an end of the back goes over a pick of the face.
  EXPECT_EQ(apart({"1000", "1110", "0010", "1011"}), "it is woven in layers");
  EXPECT_EQ(apart({"1100", "1110", "0010", "1011"}), "");
}

}  // namespace
}  // namespace selvage::fabric
