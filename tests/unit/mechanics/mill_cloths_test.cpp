// Take-up of cloths in equilibrium against the process sheets of a mill.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "places.h"
#include "scripts/benchmarks/mill_cloths.h"

namespace selvage::mechanics {
namespace {

TEST(MillCloths, TakeUpIsThatOfTheProcessSheets) {
  const auto rows = read_mill_cloths(places::scripts() + "/benchmarks/mill_cloths.csv", {});
  ASSERT_GE(rows.size(), 100U);
  struct Draft {
    int count = 0;
    double ratio = 0;
  };
  std::map<std::string, Draft> drafts;
  int near = 0, close = 0;
  for (const MillCloth& row : rows) {
    const Result<WovenEquilibrium> found = find_equilibrium(row.cloth);
    ASSERT_TRUE(found.ok()) << row.draft << ' ' << found.error().text;
    const double warp = take_up(*found, WovenSystem::warp), weft = take_up(*found, WovenSystem::weft);
    const double off = std::max(std::abs(warp - row.warp_take_up), std::abs(weft - row.weft_take_up));
    close += off <= 1.5 ? 1 : 0;
    near += off <= 3.0 ? 1 : 0;
    Draft& draft = drafts[row.draft];
    ++draft.count;
    draft.ratio += warp / row.warp_take_up;
  }
  const auto total = static_cast<double>(rows.size());
  EXPECT_GE(close / total, 0.50);
  EXPECT_GE(near / total, 0.80);
  for (const auto& [name, draft] : drafts) {
    if (draft.count < 10) continue;
    EXPECT_NEAR(draft.ratio / draft.count, 1.0, 0.07) << name;
  }
}

}  // namespace
}  // namespace selvage::mechanics
