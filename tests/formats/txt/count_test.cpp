// Yarn counts as the trades write them, against values computed here.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <tuple>

#include "formats/txt/reading.h"

namespace selvage::test {

namespace {

using namespace fabric;

Reading thread_with(const std::string& lines, const std::string& head = "") {
  return read("fabric 1\n" + head + "thread t\n" + lines + "\nmaterial polyester\nend\n");
}

double tex_of(const std::string& line, const std::string& head = "") {
  const Reading reading = thread_with(line, head);
  EXPECT_TRUE(reading.fabric) << line << "\n" << reading.text();
  if (!reading.fabric) return 0;
  return reading.fabric->threads.at(0).linear_density->tex();
}

std::string messages_of(const std::string& lines, const std::string& head = "") {
  return thread_with(lines, head).text();
}

constexpr double tex_of_ne1 = 590.5412;

}  // namespace

TEST(YarnCount, IndirectSystemsHaveTheirPliesOnEitherSide) {
  for (const std::string text :
       {"Ne 30/2", "Ne 2/30", "Ne 30s/2", "Ne 2/30s", "30/2 Ne", "Ne30/2", "Ne 30x2", "Ne 30 x 2"})
    EXPECT_NEAR(tex_of(text), tex_of_ne1 / 15, 1e-3) << text;
  for (const std::string text : {"Nm 2/60", "Nm 60/2", "nm 60 / 2", "2/60 Nm"})
    EXPECT_NEAR(tex_of(text), 1000.0 / 30, 1e-9) << text;
  EXPECT_NEAR(tex_of("Ne 60/2/2"), tex_of_ne1 / 15, 1e-3);
  EXPECT_NEAR(tex_of("Nm 2/28.5"), 2000.0 / 28.5, 1e-9);
  EXPECT_NEAR(tex_of("Nm 40/1"), 25, 1e-9);
}

TEST(YarnCount, DirectSystemsHaveFilamentsAndPlies) {
  for (const std::string text : {"dtex 167/48", "dtex 167 f48", "dtex 167f48", "dtex 167 f 48",
                                 "167 dtex f48", "167f48 dtex", "dtex 167/f48", "dtex 167/48f"}) {
    EXPECT_NEAR(tex_of(text), 16.7, 1e-12) << text;
    EXPECT_NE(messages_of(text).find("note: understood as 167 dtex, 48 filaments"), std::string::npos)
        << messages_of(text);
  }
  for (const std::string text :
       {"dtex 1400/2", "1400x2 dtex", "dtex 1400 x2", "2x1400 dtex", "1400 dtex x 2", "dtex 1400/1/2"})
    EXPECT_NEAR(tex_of(text), 280, 1e-9) << text;
  EXPECT_NE(messages_of("dtex 1400/2").find("2 plies of 1400 dtex; 2800 dtex in all"), std::string::npos);
  for (const std::string text : {"tex 20x2", "20 tex x 2", "tex 20 X 2", "tex 20 \xC3\x97 2", "R 40 tex/2",
                                 "R40 tex/2", "20 tex x 2 R 40 tex", "tex 20/2"})
    EXPECT_NEAR(tex_of(text), 40, 1e-12) << text;
  for (const std::string text : {"denier 1000/2", "1000D/2", "Td 1000/2", "1000 den x2"})
    EXPECT_NEAR(tex_of(text), 2000.0 / 9, 1e-9) << text;
  for (const std::string text : {"dtex 167 f48 x2", "dtex 167/48/2", "167 dtex f48 x 2"})
    EXPECT_NEAR(tex_of(text), 33.4, 1e-12) << text;
  EXPECT_NEAR(tex_of("denier 150/48/2"), 300.0 / 9, 1e-12);
  EXPECT_NEAR(tex_of("denier 210/2/3"), 1260.0 / 9, 1e-12);
  EXPECT_NEAR(tex_of("denier 68/24f"), 68.0 / 9, 1e-12);
}

// As textured yarns are traded: plies, count, filaments.
TEST(YarnCount, PliesInFrontOfDirectSystems) {
  EXPECT_NEAR(tex_of("denier 2/150/48"), 300.0 / 9, 1e-12);
  EXPECT_NE(messages_of("denier 2/150/48").find("2 plies of 150 denier, 48 filaments each"),
            std::string::npos);
  EXPECT_NEAR(tex_of("denier 1/70/34"), 70.0 / 9, 1e-12);
  EXPECT_NEAR(tex_of("dtex 2/78"), 15.6, 1e-12);
  EXPECT_NEAR(tex_of("dtex 2/167 f48"), 33.4, 1e-12);
  EXPECT_NEAR(tex_of("dtex 8/12"), 0.8, 1e-12);  // 12 filaments of a stocking's yarn
}

TEST(YarnCount, ThousandsOfFilaments) {
  for (const std::string text :
       {"tex 800 12k", "tex 800 12K", "800 tex 12K", "tex 800/12k", "tex 800 f12000"}) {
    EXPECT_NEAR(tex_of(text), 800, 1e-9) << text;
    EXPECT_NE(messages_of(text).find("12000 filaments"), std::string::npos) << messages_of(text);
  }
  EXPECT_NE(messages_of("12k").find("12k is a number of filaments, and no count"), std::string::npos)
      << messages_of("12k");
}

// Hanks of 300 and of 560 yards in a pound: 1 yard is 0.9144 m, 1 lb is 453.59237 g.
TEST(YarnCount, LinenAndWorsted) {
  for (const std::string text : {"NeL 25", "lea 25", "nel 25/1"})
    EXPECT_NEAR(tex_of(text), 453592.37 / (25 * 300 * 0.9144), 1e-6) << text;
  for (const std::string text : {"NeK 2/30", "worsted 30/2", "NeW 30/2"})
    EXPECT_NEAR(tex_of(text), 2 * 453592.37 / (30 * 560 * 0.9144), 1e-6) << text;
  EXPECT_NE(messages_of("NeL 25").find("300 yards in a pound"), std::string::npos);
}

TEST(YarnCount, OtherUnits) {
  EXPECT_NEAR(tex_of("ktex 4.8"), 4800, 1e-9);
  EXPECT_NEAR(tex_of("0.3 ktex"), 300, 1e-9);
  EXPECT_NEAR(tex_of("mtex 500x2"), 1, 1e-12);
  EXPECT_NEAR(tex_of("YSW 12"), 453592.37 / (12 * 256 * 0.9144), 1e-6);
  EXPECT_NEAR(tex_of("cc 20/2"), tex_of("Ne 20/2"), 1e-12);
  EXPECT_NEAR(tex_of("metric 2/28"), 1000.0 / 14, 1e-12);
}

// ISO 2078, and the American system: hundreds of yards in a pound. The remedy is what makers print as the
// tex.
TEST(YarnCount, DesignationsOfGlass) {
  for (const auto& [text, remedy, tex] :
       {std::tuple("EC9 68", "tex 68", 68.0), std::tuple("EC 13 136 x2", "tex 136x2", 272.0),
        std::tuple("G75 1/0", "tex 66.14", 66.14), std::tuple("ECG 75 1/2", "tex 66.14x2", 132.28),
        std::tuple("ECD450 1/2", "tex 11.02x2", 22.04)}) {
    EXPECT_NE(messages_of(text).find(fmt::format("write '{}'", remedy)), std::string::npos)
        << messages_of(text);
    EXPECT_NEAR(tex_of(remedy), tex, 1e-9) << remedy;
  }
  EXPECT_NE(messages_of("G string").find("unknown word"), std::string::npos);
}

// The border of the rule: 9 are plies, 10 are filaments.
TEST(YarnCount, AboveNineAreFilaments) {
  EXPECT_NEAR(tex_of("dtex 100/9"), 90, 1e-9);
  EXPECT_NEAR(tex_of("dtex 100/10"), 10, 1e-12);
}

TEST(YarnCount, RawSilkHasARange) {
  EXPECT_NEAR(tex_of("denier 20/22"), 21.0 / 9, 1e-12);
  EXPECT_NEAR(tex_of("Td 13/15"), 14.0 / 9, 1e-12);
  EXPECT_NEAR(tex_of("denier 40/44"), 42.0 / 9, 1e-12);
  EXPECT_NEAR(tex_of("denier 20/24"), 20.0 / 9, 1e-12);  // 24 filaments
  EXPECT_NEAR(tex_of("denier 70/72"), 70.0 / 9, 1e-12);
  EXPECT_NE(messages_of("denier 20/22").find("raw silk"), std::string::npos);
}

TEST(YarnCount, ExpressionsNeedBrackets) {
  EXPECT_NEAR(tex_of("dtex (100+67)"), 16.7, 1e-12);
  EXPECT_NEAR(tex_of("dtex (100+67) f48"), 16.7, 1e-12);
  EXPECT_NEAR(tex_of("dtex count", "param count 167\n"), 16.7, 1e-12);
  EXPECT_NEAR(tex_of("dtex count f48", "param count 167\n"), 16.7, 1e-12);
  for (const std::string text : {"dtex 1400*2", "dtex 100+67", "tex 20.5/2.5"})
    EXPECT_NE(messages_of(text).find("needs brackets"), std::string::npos) << messages_of(text);
  EXPECT_NE(messages_of("dtex count/2", "param count 167\n").find("needs brackets: (count/2)"),
            std::string::npos);
}

TEST(YarnCount, SaysWhatIsWrong) {
  EXPECT_NE(messages_of("dtex 167/48/72").find("both are numbers of filaments"), std::string::npos);
  EXPECT_NE(messages_of("dtex 167 48").find("joined"), std::string::npos);
  EXPECT_NE(messages_of("dtex 167 den").find("another system"), std::string::npos);
  EXPECT_NE(messages_of("dtex 167/").find("missing"), std::string::npos);
  for (const std::string text : {"tex 20 Z 660", "tex 20 S 660", "R 34 tex /2 S 600"})
    EXPECT_NE(messages_of(text).find("twist 660 Z"), std::string::npos) << messages_of(text);
  EXPECT_NE(messages_of("tex 20\n1400x2 dtex").find("given twice"), std::string::npos);
}

TEST(YarnCount, AgreesWithPliesAndFilaments) {
  EXPECT_NE(messages_of("Ne 30/2\nplies 3 400 S").find("2 plies"), std::string::npos);
  EXPECT_NE(messages_of("filaments 24\ndtex 167 f48").find("48 filaments"), std::string::npos);
  const Reading good = thread_with("dtex 167 f48 x2\nfilaments 48\nplies 2 400 S");
  ASSERT_TRUE(good.fabric) << good.text();
  EXPECT_NEAR(good.fabric->threads.at(0).linear_density->tex(), 33.4, 1e-12);
  // The number of filaments of a count builds none; one filament is a monofilament.
  EXPECT_EQ(thread_with("dtex 167 f48").fabric->threads.at(0).filaments, std::nullopt);
  EXPECT_EQ(thread_with("dtex 100 f1").fabric->threads.at(0).filaments, 1);
}

}  // namespace selvage::test
