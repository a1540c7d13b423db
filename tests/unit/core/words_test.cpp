#include "core/words.h"

#include <gtest/gtest.h>

namespace selvage {

using Words = std::vector<std::string_view>;

TEST(Words, Lists) {
  EXPECT_EQ(split("a,,b c,", ','), (Words{"a", "", "b c"}));
  EXPECT_EQ(split("", ','), Words{});
  EXPECT_EQ(words_of("  a b  c"), (Words{"a", "b", "c"}));
  EXPECT_EQ(words_of(":/a::/b:", ':'), (Words{"/a", "/b"}));
  EXPECT_EQ(alternatives({"a", "b", "c"}), "a, b or c");
  EXPECT_EQ(alternatives({"a"}), "a");
}

TEST(Words, OfAnyCase) {
  EXPECT_TRUE(same_word("Ne", "nE"));
  EXPECT_FALSE(same_word("ne", "n"));
  EXPECT_FALSE(same_word("[", "{"));  // next to the letters in ASCII
}

TEST(Words, Plurals) {
  EXPECT_EQ(counted(0, "yarn"), "0 yarns");
  EXPECT_EQ(counted(1, "yarn"), "1 yarn");
  EXPECT_EQ(counted(2, "other part"), "2 other parts");
}

}  // namespace selvage
