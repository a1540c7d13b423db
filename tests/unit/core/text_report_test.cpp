#include "core/text_report.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/text_lines.h"

namespace selvage {
namespace {

// The message of an error at this spot of the text.
Message told(const std::string& text, const Spot& spot) {
  const Source source = Source::from_memory(text, "test.txt");
  TextReport report(source);
  report.error(spot, "wrong");
  Diagnostics diagnostics;
  report.hand_over(diagnostics);
  return diagnostics.messages().front();
}

TEST(TextReport, ExcerptsShowTheLineAndTheColumn) {
  const Message message = told("first\nsecond line\r\nthird\n", Spot{6, 2, 1}.behind(7));
  EXPECT_EQ(message.place.line, 2);
  EXPECT_EQ(message.place.column, 8);
  EXPECT_EQ(message.excerpt, "second line");
  EXPECT_EQ(message.caret, 8);
  EXPECT_EQ(told("a\r\n", Spot{}.behind(1)).excerpt, "a");
  EXPECT_EQ(told("a\r\n", Spot{}.behind(2)).excerpt, "a");
  EXPECT_EQ(told("", Spot{}).excerpt, "");
}

TEST(TextReport, LongLinesAreCutBetweenCharacters) {
  std::string line;
  for (int i = 0; i < 200; ++i) line += "\xC3\xA4";
  const Message message = told(line, Spot{}.behind(201));
  EXPECT_TRUE(message.excerpt.starts_with("...\xC3\xA4"));
  EXPECT_TRUE(message.excerpt.ends_with("\xC3\xA4..."));
  EXPECT_LT(message.excerpt.size(), 130U);
}

// No spot leads out of the text, whatever its numbers are.
TEST(TextReport, EverySpotIsInTheText) {
  constexpr std::size_t far = std::numeric_limits<std::size_t>::max();
  constexpr int most = std::numeric_limits<int>::max(), least = std::numeric_limits<int>::min();
  for (const std::string& text : {std::string(), std::string("ab"), std::string("ab\ncd\n")})
    for (const std::size_t offset : {std::size_t{0}, std::size_t{1}, text.size(), far})
      for (const int column : {least, 0, 1, 2, 1000, most}) {
        const Message message = told(text, {offset, 1, column});
        EXPECT_LE(message.excerpt.size(), text.size());
        EXPECT_EQ(message.excerpt.find('\n'), std::string::npos);
      }
  EXPECT_EQ(Spot{}.behind(far).column, most);
}

TEST(TextReport, PlacesOutsideAreTheNearestInside) {
  const Source source = Source::from_memory("ab\ncd");
  for (const TextPlace place : {TextPlace{2, 100}, TextPlace{7, 1}, TextPlace{2, 3}})
    EXPECT_EQ(spot_at(source, place).offset, 5U);
  EXPECT_EQ(spot_at(source, {2, 2}).offset, 4U);
  EXPECT_EQ(spot_at(source, {0, 0}).offset, 0U);
}

TEST(TextLines, SpotsEndWithTheirLines) {
  TextLines lines("one\r\ntwo\nlast");
  EXPECT_EQ(lines.spot(50).offset, 0U);
  ASSERT_TRUE(lines.next());
  EXPECT_EQ(lines.spot(2).offset, 2U);
  EXPECT_EQ(lines.spot(50).offset, 3U);
  EXPECT_EQ(lines.spot(50).column, 4);
  ASSERT_TRUE(lines.next());
  EXPECT_EQ(lines.spot(1).offset, 6U);
  EXPECT_EQ(lines.spot(1).line, 2);
  ASSERT_TRUE(lines.next());
  EXPECT_EQ(lines.spot(99).offset, 13U);
  EXPECT_FALSE(lines.next());
  EXPECT_EQ(lines.line(), "last");
}

}  // namespace
}  // namespace selvage
