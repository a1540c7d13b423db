// What a WIF becomes: places, lengths, threads, sheds. Whole files of other programs' habits: test_wif.py.
#include <gtest/gtest.h>

#include "formats/wif/ini.h"
#include "reading.h"

namespace selvage {
namespace {

using test::plain;
using test::read;
using test::Reading;
using Rows = std::vector<std::string>;

// The plain weave with statements in [WARP] and [WEFT], and sections.
Reading with(const std::string& warp, const std::string& weft, const std::string& sections = "",
             const std::string& weaving = "") {
  return read("[WIF]\n[WEAVING]\nShafts=2\nTreadles=2\n" + weaving + "[WARP]\nThreads=2\n" + warp +
              "[WEFT]\nThreads=2\n" + weft +
              "[THREADING]\n1=1\n2=2\n[TIEUP]\n1=1\n2=2\n[TREADLING]\n1=1\n2=2\n" + sections);
}

TEST(WifReader, ThreadOneIsWarpOneAndPickOneIsTheTopRow) {
  const Reading reading = read(plain + "1=1\n2=1,2\n[TREADLING]\n1=1\n2=2\n");
  ASSERT_TRUE(reading.fabric) << reading.text();
  EXPECT_EQ(reading.weave().draft.rows, (Rows{"10", "11"}));
  EXPECT_EQ(reading.weave().warp.count, 2);
  EXPECT_EQ(reading.weave().weft.count, 2);
  EXPECT_EQ(reading.fabric->file, "test.wif");
}

TEST(WifReader, EverySpellingOfASinkingShedIsTheComplement) {
  for (const std::string word : {"true", "On", "YES", "1"})
    EXPECT_EQ(with("", "", "", "Rising Shed=" + word + "\n").weave().draft.rows, (Rows{"10", "01"})) << word;
  for (const std::string word : {"false", "Off", "NO", "0 ; sinks"})
    EXPECT_EQ(with("", "", "", "rising shed = " + word + "\n").weave().draft.rows, (Rows{"01", "10"}))
        << word;
}

TEST(WifReader, SeveralTreadlesAPickAndShaftsAnEnd) {
  const Reading reading = read(
      "[WIF]\n[WEAVING]\nShafts=3\n[WARP]\n[WEFT]\n[THREADING]\n1=1,3\n2=2\n3=3\n[TIEUP]\n1=1\n2=2\n3=2,3\n"
      "[TREADLING]\n1=1,2\n2=3\n3=1\n");
  ASSERT_TRUE(reading.fabric) << reading.text();
  EXPECT_EQ(reading.weave().draft.rows, (Rows{"110", "111", "100"}));
}

TEST(WifReader, DefaultsOfASilentFile) {
  const Reading reading = with("", "");
  ASSERT_TRUE(reading.fabric) << reading.text();
  EXPECT_EQ(reading.text(), "");
  EXPECT_EQ(reading.fabric->units, Unit::mm);
  EXPECT_EQ(reading.weave().warp.pitch, 1);
  EXPECT_EQ(reading.weave().weft.pitch, 1);
  ASSERT_EQ(reading.fabric->threads.size(), 1U);
  EXPECT_EQ(reading.fabric->threads[0].name, "yarn");
  EXPECT_EQ(reading.fabric->threads[0].diameter, 0.5);
  EXPECT_FALSE(reading.fabric->threads[0].color);
}

TEST(WifReader, LengthsKeepTheFilesNumbersAndUnit) {
  const Reading reading =
      with("Units=Inches\nSpacing=0.05\nThickness=0.02\n", "Units=inches\nSpacing=0.06\n");
  ASSERT_TRUE(reading.fabric) << reading.text();
  EXPECT_EQ(reading.fabric->units, Unit::inch);
  EXPECT_EQ(reading.weave().warp.pitch, 0.05);
  EXPECT_EQ(reading.weave().weft.pitch, 0.06);
  EXPECT_EQ(reading.fabric->find_thread(reading.weave().warp.threads[0])->diameter, 0.02);
  EXPECT_EQ(reading.fabric->find_thread(reading.weave().weft.threads[0])->diameter,
            0.025);  // half the smaller pitch
}

TEST(WifReader, DifferentUnitsMeetInMillimetres) {
  const Reading reading =
      with("Units=decipoints\nSpacing=36\nThickness=18\n", "Units=centimeters\nSpacing=0.2\n");
  ASSERT_TRUE(reading.fabric) << reading.text();
  EXPECT_EQ(reading.fabric->units, Unit::mm);
  EXPECT_NEAR(reading.weave().warp.pitch, 1.27, 1e-12);  // 720 decipoints are an inch
  EXPECT_NEAR(reading.weave().weft.pitch, 2, 1e-12);
  EXPECT_NEAR(*reading.fabric->find_thread(reading.weave().warp.threads[0])->diameter, 0.635, 1e-12);
}

TEST(WifReader, SpacingThatVariesIsItsMean) {
  const Reading reading = with("Units=cm\nSpacing=0.1\n", "", "[WARP SPACING]\n2=0.3\n");
  ASSERT_TRUE(reading.fabric) << reading.text();
  EXPECT_NEAR(reading.weave().warp.pitch, 0.2, 1e-15);
  EXPECT_NEAR(reading.weave().weft.pitch, 0.2, 1e-15);
  EXPECT_NE(reading.text().find("the spacing of [WARP] varies"), std::string::npos) << reading.text();
}

TEST(WifReader, ThreadsThatFillTheirSpacingAreReadAsTheyAre) {
  const Reading reading =
      with("Units=cm\nSpacing=0.1\nThickness=0.1\n", "Units=cm\nSpacing=0.2\nThickness=0.199\n");
  ASSERT_TRUE(reading.fabric) << reading.text();
  EXPECT_EQ(reading.fabric->find_thread(reading.weave().warp.threads[0])->diameter, 0.1);
  EXPECT_EQ(reading.fabric->find_thread(reading.weave().weft.threads[0])->diameter, 0.199);
}

TEST(WifReader, AThreadForEachColourAndThicknessInTheShortestRepeat) {
  const Reading reading = read(
      "[WIF]\n[WEAVING]\n[WARP]\nColor=2\nUnits=cm\nSpacing=0.2\nThickness=0.05\n[WEFT]\nColor=1\n"
      "[THREADING]\n1=1\n2=2\n3=1\n4=2\n5=1\n[LIFTPLAN]\n1=1\n2=2\n"
      "[WARP COLORS]\n1=1\n3=1\n5=1\n[WARP THICKNESS]\n2=0.08\n4=0.08\n"
      "[COLOR TABLE]\n1=0,500,1000\n2=1000,0,0\n[COLOR PALETTE]\nRange=0,1000\n");
  ASSERT_TRUE(reading.fabric) << reading.text();
  EXPECT_EQ(reading.weave().warp.threads, (std::vector<std::string>{"color1", "color2"}));
  EXPECT_EQ(reading.weave().weft.threads, (std::vector<std::string>{"color1_2"}));  // 0.1, not 0.05
  EXPECT_EQ(reading.fabric->find_thread("color1")->color, (yarn::Color{0, 128, 255}));
  EXPECT_EQ(reading.fabric->find_thread("color2")->color, (yarn::Color{255, 0, 0}));
  EXPECT_EQ(reading.fabric->find_thread("color2")->diameter, 0.08);
}

TEST(WifReader, ColourBesideItsNumberWhereTheTableHasNone) {
  const Reading reading = with("Color=7,255,0,51\n", "");
  ASSERT_TRUE(reading.fabric) << reading.text();
  EXPECT_EQ(reading.fabric->find_thread("color7")->color, (yarn::Color{255, 0, 51}));
}

TEST(WifReader, TitlesAreMadeFitForEveryFormat) {
  EXPECT_EQ(with("", "", "[TEXT]\nTitle=K\xF6per \"8/3\"\x01; fein\n").fabric->title,
            "K\xC3\xB6per '8/3' ; fein");
  EXPECT_EQ(with("", "", "[TEXT]\nTitle=\xE7\xBB\x87\n").fabric->title, "\xE7\xBB\x87");
  EXPECT_FALSE(with("", "", "[TEXT]\nTitle=\n").fabric->title);
}

TEST(WifReader, LineEndsAndAByteOrderMarkChangeNothing) {
  const std::string text = plain + "1=1\n2=2\n[TREADLING]\n1=1\n2=2\n";
  for (const std::string_view end : {"\r\n", "\r"}) {
    std::string other = "\xEF\xBB\xBF";
    for (const char c : text) other += c == '\n' ? end : std::string_view(&c, 1);
    const Reading reading = read(other);
    ASSERT_TRUE(reading.fabric) << reading.text();
    EXPECT_EQ(reading.weave().draft.rows, (Rows{"10", "01"}));
    EXPECT_EQ(reading.weave().warp.place.line, 6);
  }
}

TEST(WifReader, SniffsItsSectionAnywhereInTheHead) {
  const auto sniff = formats::wif::descriptor().sniff;
  EXPECT_TRUE(sniff("[WIF]\n"));
  EXPECT_TRUE(sniff("\xEF\xBB\xBF; made by hand\r\n [ wif ] \r\n"));
  EXPECT_TRUE(sniff("a line\r[Wif]"));
  EXPECT_FALSE(sniff("fabric 1\n# [WIF]\n"));
  EXPECT_FALSE(sniff("[WIFI]\nname=x\n"));
  EXPECT_FALSE(sniff(""));
}

}  // namespace
}  // namespace selvage
