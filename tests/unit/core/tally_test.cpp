#include "core/tally.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace selvage {

namespace {

Message overlap(int a, int b, double depth) {
  Message message = error(Kind::geometry,
                          fmt::format("yarns 'warp_{}' and 'weft_{}' overlap, {:.4g} mm deep", a, b, depth));
  message.at = Vec3(a, b, 0);
  return message;
}

}  // namespace

TEST(Tally, OfManyAlikeTheFirstAndTheWorst) {
  Tally tally;
  std::size_t shown = 0;
  for (int i = 0; i < 94; ++i)
    shown += tally.take(overlap(i, i + 1, i == 57 ? 0.039 : 1e-3), i == 57 ? 0.039 : 1e-3);
  EXPECT_EQ(shown, Tally::shown_of_a_kind);
  ASSERT_EQ(tally.rest().size(), 1U);
  EXPECT_EQ(to_string(tally.rest().front()),
            "error: x94, of which 74 are not shown; the worst: yarns 'warp_57' and 'weft_58' overlap, 0.039 "
            "mm deep at "
            "(57, 58, 0)");
}

TEST(Tally, EqualOnesAreOne) {
  Tally tally;
  std::size_t shown = 0;
  for (int i = 0; i < 1000; ++i) shown += tally.take(error(Kind::limit, "needs more memory than there is"));
  EXPECT_EQ(shown, 1U);
  ASSERT_EQ(tally.rest().size(), 1U);
  EXPECT_EQ(tally.rest().front().text, "x1000: needs more memory than there is");
}

// A warning of every yarn: the same words are one, others that differ in a name are one and their number.
TEST(Tally, WarningsThatDifferInNamesAreOne) {
  Tally same, named;
  std::size_t shown = 0;
  for (int i = 0; i < 12; ++i) {
    shown += same.take(
        warning(Kind::geometry, "the filaments of thread 'pa' fill 0.717").of_yarn(fmt::format("bar_{}", i)));
    shown += named.take(warning(Kind::geometry, fmt::format("yarn 'bar_{}' is bent", i)));
  }
  EXPECT_EQ(shown, 2U);
  EXPECT_TRUE(same.rest().empty());
  ASSERT_EQ(named.rest().size(), 1U);
  EXPECT_EQ(named.rest().front().text, "x12: yarn 'bar_0' is bent");
}

TEST(Tally, FewAreShownWhole) {
  Tally tally;
  for (std::size_t i = 0; i < Tally::shown_of_a_kind; ++i) {
    EXPECT_TRUE(tally.take(overlap(static_cast<int>(i), 0, 1), 1));
    EXPECT_TRUE(tally.take(warning(Kind::geometry, fmt::format("yarn 'a' is {} mm short", i))));
  }
  EXPECT_TRUE(tally.rest().empty());
}

// What is kept, and what is told, does not grow with the number of kinds either.
TEST(Tally, KindsAreBounded) {
  Tally tally;
  std::size_t shown = 0;
  std::string words = "a";
  for (int i = 0; i < 5000; ++i) {
    for (std::size_t k = words.size(); k-- > 0 && ++words[k] > 'z'; words[k] = 'a')
      if (k == 0) words += 'a';
    shown += tally.take(error(Kind::malformed, words));
  }
  EXPECT_EQ(shown, Tally::most_kinds + Tally::shown_of_a_kind);
  ASSERT_EQ(tally.rest().size(), 1U);
  EXPECT_TRUE(tally.rest().front().text.starts_with("x4900, of which 4880 are not shown; for example: "));
}

}  // namespace selvage
