// What is told of texts with many errors, or with statements that change nothing; the samples of bad texts.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "formats/txt/expected_errors.h"
#include "places.h"

namespace selvage::test {

// The files of samples/bad, all of them.
TEST(BadSamples, EachAtItsLineAndColumn) {
  const std::map<std::string, Expected> expected = {
      {"binary.txt", {1, 1, "not a text file"}},
      {"decimal_comma.txt", {5, 12, "write 0.18"}},
      {"empty.txt", {1, 1, "empty"}},
      {"misspelt.txt", {3, 3, "did you mean 'diameter'"}},
      {"nan.txt", {3, 12, "not a finite number"}},
      {"no_end.txt", {4, 1, "thread 't', opened on line 2"}},
      {"short_grid.txt", {14, 3, "8 rows; this one ends after 7"}},
      {"unknown_thread.txt", {2, 8, "unknown thread 'nothread'"}},
      {"version.txt", {1, 8, "version 2"}},
      {"weave_state.txt", {8, 9, "did you mean 'finished'"}},
      {"zero_length.txt", {8, 5, "equals the one before"}},
  };
  std::set<std::string> seen;
  for (const auto& entry : std::filesystem::directory_iterator(places::samples() + "/bad")) {
    const std::string name = entry.path().filename().string();
    const auto found = expected.find(name);
    if (found == expected.end()) continue;  // bad for a later stage than the reader
    seen.insert(name);
    SCOPED_TRACE(name);
    Result<Source> source = Source::open(entry.path());
    ASSERT_TRUE(source.ok());
    expect_errors(read(*source), {found->second});
  }
  EXPECT_EQ(seen.size(), expected.size());
}

TEST(BadInputReport, TwentyErrorsAreEnough) {
  std::string text = "fabric 1\n";
  for (int i = 0; i < 100; ++i) text += "thread t" + std::to_string(i) + "\n  tex 0\nend\n";
  const Reading reading = read(text + "yarn y nothread\n");
  EXPECT_FALSE(reading.fabric);
  EXPECT_EQ(reading.diagnostics.messages().size(), 20U);
  for (std::size_t i = 0; i < 20; ++i)
    EXPECT_EQ(reading.diagnostics.messages()[i].place.line, 3 + 3 * static_cast<int>(i));
}

TEST(BadInputReport, ErrorsFoundLateStandInTheOrderOfLines) {
  const Reading reading = read("fabric 1\nyarn y t\n path\n0 0 0\n1 0 0\nend\nend\nthread u\n  tex 0\nend\n");
  expect_errors(reading, {{2, 8, "unknown thread"}, {9, 7, "larger than 0"}});
}

TEST(BadInputReport, ShowsTheLineAndACaret) {
  const Reading reading = read("fabric 1\nthread t\n\tdiameter 0,18   # D\r\nend\n");
  EXPECT_EQ(reading.text(),
            "test.txt:3:11: error: the diameter: a decimal comma in '0,18': the decimal mark is the point, "
            "write 0.18\n"
            "  \tdiameter 0,18   # D\n"
            "  \t         ^\n");
}

TEST(BadInputReport, CaretStandsUnderWideLetters) {
  const Reading reading = read("fabric 1\nthread \"Grün\" x y\nend\n");
  const std::string text = reading.text();
  EXPECT_NE(text.find("\n  thread \"Grün\" x y\n                ^\n"), std::string::npos) << text;
}

TEST(BadInputReport, LongLinesAreCutRoundTheCaret) {
  std::string text = "fabric 1\nthread t\n";
  for (int i = 0; i < 1000; ++i) text += "  ";
  text += "tex oops";
  for (int i = 0; i < 100000; ++i) text += " 1234567";
  const Reading reading = read(text + "\nend\n");
  const Message& message = reading.diagnostics.messages().at(0);
  EXPECT_EQ(message.place.line, 3);
  EXPECT_EQ(message.place.column, 2005);
  EXPECT_LT(message.excerpt.size(), 140U);
  EXPECT_EQ(message.excerpt.substr(static_cast<std::size_t>(message.caret - 1), 4), "oops");
  EXPECT_TRUE(message.excerpt.starts_with("..."));
  EXPECT_TRUE(message.excerpt.ends_with("..."));
}

TEST(BadInputReport, ALineOfWideLettersIsCutBetweenThem) {
  std::string text = "fabric 1\ntitle ";
  for (int i = 0; i < 500; ++i) text += "絹";
  const Reading reading = read(text + "\n");
  const std::string excerpt = reading.diagnostics.messages().at(0).excerpt;
  EXPECT_EQ(excerpt.find('?'), std::string::npos) << excerpt;
}

TEST(BadInputReport, NamesTheYarn) {
  const Reading reading = read("fabric 1\nyarn warp_7\n path\n0 0 0\n1 x 0\n2 0 0\nend\nend\n");
  EXPECT_EQ(reading.diagnostics.messages().at(0).yarn, "warp_7");
}

TEST(BadInputReport, VersionIsUnsupportedNotMalformed) {
  EXPECT_EQ(read("fabric 3\n").diagnostics.messages().at(0).kind, Kind::unsupported);
}

// Names are looked for as long as errors are told, not for every reference (this took minutes).
TEST(BadInputReport, ThousandsOfUnknownNames) {
  std::string text = "fabric 1\n";
  for (int i = 0; i < 20000; ++i) text += "thread t" + std::to_string(i) + "\n diameter 0.1\nend\n";
  for (int i = 0; i < 20000; ++i)
    text += "yarn y" + std::to_string(i) + " u" + std::to_string(i) +
            "\n path polyline\n0 0 0\n1 0 0\nend\nend\n";
  EXPECT_EQ(read(text).diagnostics.error_count(), 20);
}

// A word that changes nothing is a warning, and the model is there.
TEST(Warnings, StatementsWithoutEffect) {
  const Reading reading = read(
      "fabric 1\nyarn a\n tangent end 1 0 0\n path polyline\n0 0 0\n1 0 0\nend\nend\n"
      "yarn b\n up 0 0 1\n grid 2 3\n"
      "0 0 0\n0 1 0\n0 0 1\n1 0 0\n1 1 0\n1 0 1\nend\nend\n");
  EXPECT_TRUE(reading.fabric) << reading.text();
  ASSERT_EQ(reading.diagnostics.messages().size(), 2U);
  EXPECT_EQ(reading.diagnostics.messages()[0].place.line, 3);
  EXPECT_EQ(reading.diagnostics.messages()[1].place.line, 10);
  EXPECT_FALSE(reading.diagnostics.has_errors());
}

}  // namespace selvage::test
