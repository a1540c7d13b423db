#include "core/diagnostics.h"

#include <gtest/gtest.h>

namespace selvage {

TEST(Message, LeavesOutWhatIsUnknown) {
  Message message = error(Kind::malformed, "it is wrong");
  EXPECT_EQ(to_string(message), "error: it is wrong");
  message.file = "a.txt";
  EXPECT_EQ(to_string(message), "a.txt: error: it is wrong");
  message.place.line = 3;
  EXPECT_EQ(to_string(message), "a.txt:3: error: it is wrong");
  message.place.column = 7;
  EXPECT_EQ(to_string(message), "a.txt:3:7: error: it is wrong");
  message.severity = Severity::warning;
  EXPECT_EQ(to_string(message), "a.txt:3:7: warning: it is wrong");
}

TEST(Message, NamesYarnAndPlaceInSpace) {
  Message message = error(Kind::geometry, "the yarn folds");
  message.yarn = "warp1";
  message.at = Vec3(1, 0.5, -2);
  EXPECT_EQ(to_string(message), "error: the yarn folds (yarn 'warp1') at (1, 0.5, -2)");
  message.text = "yarn 'warp1' folds";
  EXPECT_EQ(to_string(message), "error: yarn 'warp1' folds at (1, 0.5, -2)");
  message.at = Vec3(1, 2e-17, -1e-16);
  EXPECT_EQ(to_string(message), "error: yarn 'warp1' folds at (1, 0, 0)");
  message.at = Vec3(1, 0.5, -2);
  message.yarn = "y";  // a letter of the text is not its name
  EXPECT_EQ(to_string(message), "error: yarn 'warp1' folds (yarn 'y') at (1, 0.5, -2)");
}

TEST(Message, CaretStandsUnderItsColumn) {
  Message message = error(Kind::malformed, "no");
  message.excerpt = "tex x";
  message.caret = 5;
  EXPECT_EQ(to_string(message), "error: no\n  tex x\n      ^");
  message.excerpt = "\ttex x";
  message.caret = 6;
  EXPECT_EQ(to_string(message), "error: no\n  \ttex x\n  \t    ^");
  message.excerpt = "\"Gr\xC3\xBCn\" x";  // 8 columns, 9 bytes
  message.caret = 9;
  EXPECT_EQ(to_string(message), "error: no\n  \"Gr\xC3\xBCn\" x\n         ^");
}

TEST(NearestWord, FindsWhatWasMeant) {
  const std::vector<std::string_view> known = {"diameter", "density", "denier", "tex", "twist"};
  EXPECT_EQ(nearest_word("diametr", known), "diameter");
  EXPECT_EQ(nearest_word("DIAMETRE", known), "diameter");  // a swap is one step
  EXPECT_EQ(nearest_word("densty", known), "density");
  EXPECT_EQ(nearest_word("txe", known), "tex");
  EXPECT_EQ(nearest_word("twist", known), "twist");
}

TEST(NearestWord, FindsNothingFarAway) {
  const std::vector<std::string_view> known = {"diameter", "tex"};
  EXPECT_EQ(nearest_word("radius", known), "");
  EXPECT_EQ(nearest_word("xyz", known), "");
  EXPECT_EQ(nearest_word(std::string(1000, 'd'), known), "");
  EXPECT_EQ(nearest_word("tex", {}), "");
}

TEST(Diagnostics, KeepsAsManyErrorsAsItShows) {
  Diagnostics diagnostics(2);
  EXPECT_FALSE(diagnostics.has_errors());
  EXPECT_EQ(diagnostics.first_error(), nullptr);
  diagnostics.add(warning(Kind::malformed, "w"));
  EXPECT_FALSE(diagnostics.has_errors());
  for (const char* text : {"a", "b", "c"}) diagnostics.add(error(Kind::malformed, text));
  diagnostics.add(warning(Kind::malformed, "late"));
  EXPECT_TRUE(diagnostics.is_full());
  EXPECT_EQ(diagnostics.error_count(), 3);
  ASSERT_EQ(diagnostics.messages().size(), 4U);
  EXPECT_EQ(diagnostics.first_error()->text, "a");
  EXPECT_EQ(diagnostics.messages()[2].text, "b");
  EXPECT_EQ(diagnostics.messages()[3].text, "late");
}

TEST(Result, HoldsEither) {
  Result<int> good = 7;
  ASSERT_TRUE(good.ok());
  EXPECT_EQ(*good, 7);
  Result<int> bad = error(Kind::limit, "too much");
  ASSERT_FALSE(bad.ok());
  EXPECT_EQ(bad.error().kind, Kind::limit);
  Status status;
  EXPECT_TRUE(status.ok());
  status = error(Kind::io, "full");
  EXPECT_FALSE(status.ok());
  EXPECT_EQ(status.error().text, "full");
}

}  // namespace selvage
