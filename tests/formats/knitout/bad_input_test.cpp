// Bad programs: refused at the right place, warned of where they can be read, never a crash.
#include <gtest/gtest.h>

#include "places.h"
#include "reading.h"

namespace selvage {
namespace {

using test::head;
using test::read;
using test::Reading;

struct Bad {
  std::string name;
  std::string text;
  TextPlace place;
  std::string part;  // of the message
  Kind kind = Kind::malformed;
};

// Behind the four lines of the head; loops on f1, f2 and f3 by lines 5 to 7.
const std::string three = head + "knit + f1 1\nknit + f2 1\nknit + f3 1\n";

std::string again(const std::string& line, int times) {
  std::string text;
  for (int i = 0; i < times; ++i) text += line;
  return text;
}

std::string all_carriers(int count) {
  std::string names;
  for (int i = 1; i <= count; ++i) names += " " + std::to_string(i);
  return names;
}

// Forty needles of each bed with thirty loops each, and a racking that moves them all past each other.
std::string passings() {
  std::string text = head;
  for (const bool moves : {true, false})
    for (int needle = 1; needle <= 40; ++needle) {
      const std::string name = std::to_string(needle);
      text += again("tuck + f" + name + " 1\n", 30);
      if (moves) text += "xfer f" + name + " b" + name + "\n";
    }
  return text + "rack -24\nrack 24\nknit + f50 1\n";
}

std::vector<Bad> bad_programs() {
  constexpr Kind unsupported = Kind::unsupported;
  return {
      {"empty", "", {1, 1}, "this is no knitout program"},
      {"first_line", ";!knit-2\n", {1, 1}, "its first line is not ';!knitout-2'"},
      {"version", ";!knitout-two\nin 1\n", {1, 1}, "'two' is no version of knitout"},
      {"no_loop", head, {1, 1}, "knits no loop"},
      {"gauge_word", ";!knitout-2\n;;Gauge: fine\nin 1\n", {2, 10}, "'fine' is no gauge"},
      {"gauge_zero", ";!knitout-2\n;;Gauge: 0\nin 1\n", {2, 10}, "'0' is no gauge"},
      {"carrier_twice_in_header", ";!knitout-2\n;;Carriers: 1 2 1\nin 1\n", {2, 17}, "'1' is named twice"},
      {"unknown_word", head + "purl + f1 1\n", {5, 1}, "unknown operation 'purl'"},
      {"misspelt_word", head + "knti + f1 1\n", {5, 1}, "did you mean 'knit'?"},
      {"case_matters", head + "KNIT + f1 1\n", {5, 1}, "unknown operation 'KNIT'; did you mean 'knit'?"},
      {"no_direction", head + "knit f1 1\n", {5, 6}, "'f1' is no direction"},
      {"nothing_behind", head + "knit\n", {5, 5}, "the direction is missing: knit DIRECTION NEEDLE"},
      {"no_needle", head + "knit +  \n", {5, 7}, "the needle is missing"},
      {"needle_without_bed", head + "knit + 12 1\n", {5, 8}, "'12' is no needle"},
      {"needle_word", head + "knit + fx 1\n", {5, 8}, "'fx' is no needle"},
      {"needle_fraction", head + "knit + f1.5 1\n", {5, 8}, "'f1.5' is no needle"},
      {"needle_overflow", head + "knit + f99999999999 1\n", {5, 8}, "beyond every bed", Kind::limit},
      {"needle_far", head + "knit + f10000 1\n", {5, 8}, "numbers go from -9999 to 9999", Kind::limit},
      {"needles_apart", head + "knit + f-700 1\nknit + b500 1\n", {6, 8}, "are 1201 needles", Kind::limit},
      {"carrier_unknown", head + "knit + f1 7\n", {5, 11}, "no carrier '7': the header names 1 2 3"},
      {"carrier_not_in",
       head + "knit + f1 2\n",
       {5, 11},
       "carrier '2' is not in: bring it in before, by 'inhook 2'"},
      {"carrier_twice", head + "knit + f1 1 1\n", {5, 13}, "carrier '1' is named twice"},
      {"in_twice", head + "in 1\n", {5, 4}, "carrier '1' is in already, since line 4"},
      {"in_nothing", head + "in\n", {5, 3}, "the carrier is missing: in CARRIERS"},
      {"out_twice", three + "out 1\nout 1\n", {9, 5}, "carrier '1' is not in"},
      {"out_unknown", three + "outhook 9\n", {8, 9}, "no carrier '9'"},
      {"not_hooked", three + "releasehook 1\nreleasehook 1\n", {9, 13}, "not in the hook"},
      {"rack_word", head + "rack left\n", {5, 6}, "'left' is no number"},
      {"rack_comma", head + "rack 0,25\n", {5, 6}, "the decimal mark is the point"},
      {"rack_far",
       head + "rack 25\n",
       {5, 1},
       "racking 25 is beyond the bed: it goes from -24 to 24",
       Kind::limit},
      {"rack_two", head + "rack 1 2\n", {5, 8}, "'2' is too much: rack NEEDLES"},
      {"stitch_one", head + "stitch 5\n", {5, 9}, "a number is missing: stitch BEFORE AFTER"},
      {"drop_two", three + "drop f1 f2\n", {8, 9}, "'f2' is too much: drop NEEDLE"},
      {"xfer_one_bed", three + "xfer f1 f2\n", {8, 9}, "f1 and f2 are on one bed"},
      {"xfer_askew",
       three + "xfer f1 b2\n",
       {8, 9},
       "at racking 0 it faces b1; 'rack -1' brings them together"},
      {"xfer_racked", three + "rack 2\nxfer f3 b3\n", {9, 9}, "at racking 2 it faces b1; 'rack 0' brings"},
      {"xfer_quarter", three + "rack 0.25\nxfer f1 b1\n", {9, 9}, "rack a whole number"},
      {"knit_on_slider", head + "knit + fs1 1\n", {5, 8}, "fs1 is a slider, which only holds loops"},
      {"split", three + "split - f3 b3 1\n", {8, 1}, "a split is not supported", unsupported},
      {"face_to_face", head + "knit + f1 1\nknit + b1 1\n", {6, 1}, "cannot knit in one pass", unsupported},
      {"moved_too_far",
       three + "xfer f3 b3\nrack 13\nxfer b3 f16\nknit + f16 1\n",
       {7, 1},
       "moved by 13 wales",
       unsupported},
      {"a_chart_too_large",
       head +
           [] {
             std::string text;
             for (int i = 0; i < 20'000; ++i) text += "knit + f1 1\nknit + f1200 1\n";
             return text;
           }(),
       {5, 1},
       "20000 rows by 1200 wales are beyond",
       Kind::limit},
      {"a_chart_of_few_loops",
       head + again("knit + f1 1\nknit + f1200 1\n", 2500),
       {5, 1},
       "2500 rows by 1200 wales are beyond the 2500000 stitches that the chart of 5000 loops may have",
       Kind::limit},
      {"tucks_on_one_needle",
       head + again("tuck + f1 1\n", 33),
       {37, 8},
       "f1 would hold 33 loops, and a needle holds at most 32",
       Kind::limit},
      {"moved_onto_one_needle",
       head + again("tuck + f1 1\n", 20) + again("tuck + b1 1\n", 20) + "xfer f1 b1\n",
       {45, 9},
       "b1 would hold 40 loops",
       Kind::limit},
      {"carriers_in_header",
       ";!knitout-2\n;;Carriers:" + all_carriers(1001) + "\nin 1\nknit + f1 1\n",
       {2, 3906},
       "a machine has at most 1000 carriers",
       Kind::limit},
      {"carriers_without_header",
       ";!knitout-2\nin" + all_carriers(1001) + "\nknit + f1 1\n",
       {2, 3897},
       "a machine has at most 1000 carriers",
       Kind::limit},
      {"passings", passings(), {2447, 1}, "have moved loops past each other", Kind::limit},
  };
}

class KnitoutBadInput : public testing::TestWithParam<Bad> {};

TEST_P(KnitoutBadInput, IsRefusedAtItsPlace) {
  const Reading reading = read(GetParam().text);
  EXPECT_FALSE(reading.fabric);
  const Message* first = reading.diagnostics.first_error();
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(first->place.line, GetParam().place.line) << first->text;
  EXPECT_EQ(first->place.column, GetParam().place.column) << first->text;
  EXPECT_NE(first->text.find(GetParam().part), std::string::npos) << first->text;
  EXPECT_EQ(first->kind, GetParam().kind);
}

INSTANTIATE_TEST_SUITE_P(programs, KnitoutBadInput, testing::ValuesIn(bad_programs()),
                         [](const auto& one) { return one.param.name; });

struct Warned {
  std::string name, text;
  int line;
  std::string part;
};

class KnitoutWarnings : public testing::TestWithParam<Warned> {};

TEST_P(KnitoutWarnings, AreToldAtTheirLine) {
  const Reading reading = read(GetParam().text);
  EXPECT_TRUE(reading.fabric);
  bool is_told = false;
  for (const Message& message : reading.diagnostics.messages())
    is_told = is_told || (message.place.line == GetParam().line &&
                          message.text.find(GetParam().part) != std::string::npos);
  EXPECT_TRUE(is_told);
}

INSTANTIATE_TEST_SUITE_P(
    programs, KnitoutWarnings,
    testing::Values(
        Warned{"no_first_line", "in 1\nknit + f1 1\nknit + f2 1\nout 1\n", 1,
               "the first line of a knitout program is missing: write ';!knitout-2'"},
        Warned{"no_carriers", ";!knitout-2\nin 1\nknit + f1 1\nout 1\n", 2, "the header names no carriers"},
        Warned{"hook", three + "out 1\n", 4, "carrier '1' is never released from the inserting hook"},
        Warned{"float", three + "knit + f20 1\nout 1\n", 8,
               "carrier '1' floats past 16 needles on its way to f20"},
        Warned{"floats", three + "knit + f20 1\nknit - f3 1\nout 1\n", 8,
               "2 floats of the program are longer than 8 needles"},
        Warned{"undone", three + "drop f3\nknit - f2 1\nout 1\n", 8,
               "the loop dropped from f3 is drawn through no other one and comes undone"},
        Warned{"together", head + "in 2\nknit + b1 1 2\nknit + b2 1 2\nout 1 2\n", 6,
               "carriers 1 2 are knitted together"},
        Warned{"newer_version", ";!knitout-3\nin 1\nknit + f1 1\nout 1\n", 1, "version 3"},
        Warned{"extension", three + "x-presser-mode auto\nx-presser-mode on\n", 8,
               "'x-presser-mode' is passed by, here and below"},
        Warned{"left_in", three, 4, "carrier '1' is never taken out"},
        Warned{"ladder", three + "knit - f3 1\nknit - f2 1\ndrop f2\nknit - f1 1\nout 1\n", 10,
               "the loop dropped from f2 runs"},
        Warned{"ladders", three + "knit - f3 1\nknit - f2 1\ndrop f2\ndrop f3\nknit - f1 1\nout 1\n", 10,
               "the loop dropped from f2 and another needle runs"},
        Warned{"in_for_nothing", three + "inhook 2\nouthook 2\nout 1\n", 8,
               "carrier '2' is brought in, and knits nothing"},
        Warned{"no_gauge", ";!knitout-2\nin 1\nknit + f1 1\nout 1\n", 3, "15 is taken"},
        Warned{"no_thickness", three, 5, "no thickness of the yarn of carrier '1'"}),
    [](const auto& one) { return one.param.name; });

// What is knitted before an operation that is not supported is a cloth; `line`: where it ends.
struct Beginning {
  std::string name, text;
  int line, rows;
  std::string part;  // of the warning
};

const std::string two_rows = three + "knit - f3 1\nknit - f2 1\nknit - f1 1\n";

class KnitoutBeginnings : public testing::TestWithParam<Beginning> {};

TEST_P(KnitoutBeginnings, AreBuilt) {
  const Reading reading = read(GetParam().text);
  ASSERT_TRUE(reading.fabric) << reading.text();
  EXPECT_NE(reading.text().find(GetParam().part), std::string::npos) << reading.text();
  const std::string end = "; the cloth ends before line " + std::to_string(GetParam().line) + ":";
  EXPECT_NE(reading.text().find(end), std::string::npos) << reading.text();
  const auto& knit = std::get<fabric::Knit>(reading.fabric->items.front());
  EXPECT_EQ(knit.chart.size(), static_cast<std::size_t>(GetParam().rows));
}

INSTANTIATE_TEST_SUITE_P(
    programs, KnitoutBeginnings,
    testing::Values(
        Beginning{"split", two_rows + "split + f1 b1 1\nknit + f2 1\nknit + f3 1\n", 11, 2,
                  "a split is not supported"},
        Beginning{"bind_off",  // each loop to its neighbour, through which the next one is drawn, in a chain
                  two_rows +
                      again("knit + f1 1\nxfer f1 b1\nrack 1\nxfer b1 f2\nrack 0\nknit + f2 1\n"
                            "xfer f2 b2\nrack -1\nxfer b2 f1\nrack 0\n",
                            9) +
                      "knit - f3 1\n",
                  101, 20, "held over more than 6 courses"},
        Beginning{"moved_too_far", two_rows + "xfer f3 b3\nrack 13\nxfer b3 f16\nrack 0\nknit + f16 1\n", 15,
                  2, "moved by 13 wales"},
        Beginning{"held_too_long", two_rows + again("knit + f1 1\nknit - f1 1\n", 8) + "knit + f3 1\n", 27,
                  18, "held over more than 6 courses"}),
    [](const auto& one) { return one.param.name; });

TEST(Knitout, WarnsOnceOfAnExtension) {
  const Reading reading = read(three + "x-speed 1\nx-speed 2\nx-speed 3\nout 1\n");
  int told = 0;
  for (const Message& message : reading.diagnostics.messages())
    told += message.text.find("x-speed") != std::string::npos ? 1 : 0;
  EXPECT_EQ(told, 1);
}

}  // namespace
}  // namespace selvage
