// Bad files: refused at the right place, warned of where they can be read, never a crash.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "places.h"
#include "reading.h"

namespace selvage {
namespace {

using test::plain;
using test::read;
using test::Reading;

struct Bad {
  std::string name;
  std::string text;
  TextPlace place;
  std::string part;  // of the message
  Kind kind = Kind::malformed;
};

const std::string rest = "1=1\n2=2\n[TREADLING]\n1=1\n2=2\n";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  text.replace(text.find(what), what.size(), by);
  return text;
}

const std::string whole = plain + rest;

std::vector<Bad> bad_files() {
  return {
      {"empty", "", {1, 1}, "the section [WIF] is missing"},
      {"no_wif", replaced(whole, "[WIF]", "[WOOF]"), {1, 1}, "the section [WIF] is missing"},
      {"utf_16", "\xFF\xFE[\0W\0", {1, 1}, "UTF-16"},
      {"zeros", whole + std::string(3, '\0'), {1, 1}, "zero bytes"},
      {"no_weaving", replaced(whole, "[WEAVING]", "[WAVING]"), {19, 1}, "[WEAVING] is missing"},
      {"no_warp", replaced(whole, "[WARP]", "[PRIVATE]"), {19, 1}, "[WARP] is missing"},
      {"no_weft", replaced(whole, "[WEFT]", "[PRIVATE]"), {19, 1}, "[WEFT] is missing"},
      {"no_threading", replaced(whole, "[THREADING]", "[PRIVATE]"), {19, 1}, "[THREADING] is missing"},
      {"no_tieup", replaced(whole, "[TIEUP]", "[PRIVATE]"), {16, 1}, "needs [TIEUP]"},
      {"no_treadling", replaced(whole, "[TREADLING]", "[PRIVATE]"), {19, 1}, "[TREADLING] is missing"},
      {"no_shed", plain, {14, 1}, "neither [LIFTPLAN] nor"},
      {"empty_threading", replaced(whole, "1=1\n2=2\n[T", "[T"), {10, 1}, "[THREADING] is empty"},
      {"nothing_threaded",
       replaced(whole, "1=1\n2=2\n[T", "1=0\n2=\n[T"),
       {10, 1},
       "no thread is on a shaft"},
      {"shaft_beyond", replaced(whole, "1=1", "1=3"), {11, 3}, "shaft 3 is beyond the 2 shafts of [WEAVING]"},
      {"treadle_beyond",
       plain + replaced(rest, "[TREADLING]\n1=1", "[TREADLING]\n1=1,3"),
       {17, 3},
       "treadle 3 is beyond the 2"},
      {"shaft_negative", replaced(whole, "1=1", "1=-1"), {11, 3}, "no shaft -1"},
      {"shafts_zero", replaced(whole, "Shafts=2", "Shafts=0"), {4, 8}, "0 is not a number of shafts"},
      {"shafts_empty", replaced(whole, "Shafts=2", "Shafts="), {4, 8}, "no value"},
      {"treadle_zero", plain + "0=1\n" + rest, {14, 1}, "no treadle 0: they count from 1"},
      {"thread_zero", replaced(whole, "1=1", "0=1"), {11, 1}, "no thread 0"},
      {"thread_beyond", whole + "3=1\n", {19, 1}, "thread 3 is beyond the 2 threads of [WEFT]"},
      {"key_no_number", replaced(whole, "1=1", "one=1"), {11, 1}, "'one' is not the number of a thread"},
      {"value_no_number", replaced(whole, "1=1", "1=1 x"), {11, 3}, "'1 x' is no whole number"},
      {"list_no_number", replaced(whole, "1=1", "1=1, x2"), {11, 6}, "'x2' is no whole number"},
      {"value_too_long", replaced(whole, "1=1", "1=99999999999"), {11, 3}, "no whole number"},
      {"shed", replaced(whole, "Treadles=2", "Rising Shed=perhaps"), {5, 13}, "neither true"},
      {"threads_absurd",
       replaced(whole, "Threads=2", "Threads=1000000000"),
       {7, 9},
       "1000000000 threads are beyond",
       Kind::limit},
      {"threads_negative",
       replaced(whole, "Threads=2", "Threads=-4"),
       {7, 9},
       "-4 is not a number of threads"},
      {"thread_absurd",
       replaced(replaced(whole, "Threads=2\n", "\n"), "1=1", "2000000=1"),
       {11, 1},
       "beyond the 1000000 that are taken",
       Kind::limit},
      {"crossings_absurd",
       replaced(
           replaced(replaced(replaced(whole, "Threads=2\n", "\n"), "Threads=2\n", "\n"), "1=1", "1000000=1"),
           "[TREADLING]\n1=1", "[TREADLING]\n1000000=1"),
       {16, 1},
       "1000000 picks by 1000000 threads",
       Kind::limit},
      {"loose_treadle",
       replaced(replaced(whole, "Treadles=2\n", "\n"), "2=2\n[TR", "[TR"),
       {17, 3},
       "treadle 2 has no tie-up"},
      {"unit", replaced(whole, "Threads=2", "Spacing=1\nUnits=ells"), {8, 7}, "'ells' is no unit of a WIF"},
      {"decimal_comma", replaced(whole, "Threads=2", "Spacing=0,1\nUnits=cm"), {7, 9}, "decimal comma"},
      {"spacing_negative",
       replaced(whole, "Threads=2", "Spacing=-0.1\nUnits=cm"),
       {7, 9},
       "lies between 0 and"},
      {"spacing_nan", replaced(whole, "Threads=2", "Spacing=nan\nUnits=cm"), {7, 9}, "'nan' is no number"},
      {"color_range", whole + "[COLOR PALETTE]\nRange=255,0\n", {20, 7}, "the smaller one first"},
      {"color_short",
       whole + "[COLOR PALETTE]\nRange=0,255\n[COLOR TABLE]\n1=1,2\n",
       {22, 3},
       "three whole numbers, not 2"},
      {"color_outside",
       whole + "[COLOR PALETTE]\nRange=0,255\n[COLOR TABLE]\n1=1,2,256\n",
       {22, 3},
       "256 is not within"},
  };
}

TEST(WifBadInput, EachIsRefusedAtItsPlace) {
  for (const Bad& bad : bad_files()) {
    SCOPED_TRACE(bad.name);
    const Reading reading = read(bad.text);
    EXPECT_FALSE(reading.fabric);
    const Message* const error = reading.diagnostics.first_error();
    ASSERT_NE(error, nullptr);
    EXPECT_EQ(error->place.line, bad.place.line) << reading.text();
    EXPECT_EQ(error->place.column, bad.place.column) << reading.text();
    EXPECT_NE(error->text.find(bad.part), std::string::npos) << reading.text();
    EXPECT_EQ(error->kind, bad.kind) << reading.text();
    EXPECT_EQ(error->file, "test.wif");
  }
}

TEST(WifBadInput, WhatCanBeReadIsWarnedOf) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"prelude\n" + whole, "test.wif:1:1: warning: text before the first section"},
      {whole + "[WARP]\nSpacing=0.1\nUnits=cm\n",
       "test.wif:19:1: warning: the section 'WARP' stands here once more"},
      {replaced(whole, "1=1\n", "1=1\n1=2\n"), "test.wif:12:1: warning: thread 1 stands here once more"},
      {whole + "3=0\n",
       "test.wif:19:1: warning: thread 3 is beyond the 2 threads of [WEFT]; it is passed by"},
      {whole + "3\n", "test.wif:19:1: warning: a line without '='"},
      {replaced(whole, "Version=1.1", "Version=2"), "test.wif:2:9: warning: a WIF of a later version"},
      {replaced(whole, "Treadles=2", "Treadles=3\nProfile=yes"), "test.wif:6:1: warning: a profile draft"},
      {replaced(whole, "Threads=2", "Threads=5"), "[THREADING] ends with thread 2 of the 5 of [WARP]"},
      {replaced(whole, "Threads=2", "Spacing=0.1"), "test.wif:6:1: warning: [WARP] has lengths but no Units"},
      {replaced(whole, "Threads=2", "Color=4"),
       "test.wif:7:7: warning: color 4, but there is no [COLOR TABLE]"},
      {whole + "[CONTENTS]\nWARP COLORS=true\n", "test.wif:20:1: warning: [CONTENTS] promises [WARP COLORS]"},
      {whole + "[LIFTPLAN]\n1=1\n2=1\n", "test.wif:19:1: warning: [LIFTPLAN] and [TREADLING] differ"},
      {replaced(whole, "1=1\n2=2\n[TI", "1=1\n2=0\n[TI"), "thread 2 lies on one side of every pick"},
      {whole + "[COLOR TABLE]\n1=0,0,0\n", "test.wif:19:1: warning: [COLOR PALETTE] gives no Range"},
      {plain + replaced(rest, "2=2", "2=1, 5"),
       "test.wif:15:3: warning: [TIEUP] has shaft 5, and [WEAVING] says 2 shafts"},
      {plain + "7=1\n8=2\n" + rest,
       "test.wif:14:1: warning: [TIEUP] has treadle 7 (and 1 more), and [WEAVING] says 2 treadles"},
  };
  for (const auto& [text, part] : cases) {
    const Reading reading = read(text);
    EXPECT_TRUE(reading.fabric) << text << reading.text();
    EXPECT_NE(reading.text().find(part), std::string::npos) << part << "\n" << reading.text();
  }
  EXPECT_EQ(read(whole).text(), "");
  EXPECT_EQ(read(whole + "[LIFTPLAN]\n1=1\n2=2\n").text(), "");  // both, but they agree
}

// The tie-up of the whole loom, of which the draft uses a part: the cloth is that of the part.
TEST(WifBadInput, SurplusOfTheLoomChangesNothing) {
  const std::string surplus = plain + "3=1,2\n4=3\n" + rest;
  const auto rows = [](const std::string& text) {
    const Reading reading = read(text);
    EXPECT_TRUE(reading.fabric) << reading.text();
    return std::get<fabric::Weave>(reading.fabric->items.front()).draft.rows;
  };
  EXPECT_EQ(rows(surplus), rows(whole));
}

TEST(WifBadInput, TwentyErrorsAreEnough) {
  std::string text = plain;
  for (int i = 0; i < 100; ++i) text += "x=1\n";
  EXPECT_EQ(read(text + "[TREADLING]\n1=1\n").diagnostics.error_count(), 20);
}

// Each is found by its name, not by going through all (this took minutes).
TEST(WifBadInput, ManySectionsCanBeRead) {
  std::string text = whole;
  for (int i = 0; i < 200000; ++i) text += "[PRIVATE " + std::to_string(i) + "]\n";
  text += "[private 7]\n";
  const Reading reading = read(text);
  EXPECT_TRUE(reading.fabric);
  EXPECT_EQ(reading.diagnostics.messages().size(), 1U);
}

TEST(WifBadInput, ManyTreadlesMayBeLoose) {
  std::string text = replaced(plain, "Treadles=2", "Treadles=300000") + rest + "2=1";
  for (int i = 3; i <= 300000; ++i) text += "," + std::to_string(i);
  const Reading reading = read(replaced(text, "[TREADLING]\n1=1\n2=2\n2=", "[TREADLING]\n1=1\n2="));
  EXPECT_TRUE(reading.fabric);
  EXPECT_NE(reading.text().find("more warnings"), std::string::npos);
}

// Cut off anywhere, and with any byte made another one: a fabric or an error.
TEST(WifBadInput, DamagedFilesAreReadOrRefused) {
  for (const std::string name :
       {"/two_shafts_an_end.wif", "/arahweave_satin.wif", "/sinking_countermarch.wif"}) {
    std::ifstream file(places::tests() + "/formats/wif/files" + name, std::ios::binary);
    const std::string good{std::istreambuf_iterator<char>(file), {}};
    ASSERT_TRUE(read(good).fabric) << name;
    int refused = 0;
    for (std::size_t length = 0; length < good.size(); ++length) {
      const Reading cut = read(good.substr(0, length));
      EXPECT_NE(cut.fabric.has_value(), cut.diagnostics.has_errors()) << name << " cut at " << length;
      if (!cut.fabric) ++refused;
      for (const char c : {'9', '=', '\n', '\xFF', '['}) {
        std::string other = good;
        other[length] = c;
        const Reading damaged = read(other);
        EXPECT_NE(damaged.fabric.has_value(), damaged.diagnostics.has_errors()) << name << " at " << length;
      }
    }
    EXPECT_GT(refused, 100) << name;
  }
}

}  // namespace
}  // namespace selvage
