#include "core/option.h"

#include <gtest/gtest.h>

namespace selvage {

namespace {

std::string canonical(const Argument& argument, std::string_view given) {
  const Result<std::string> value = argument.canonical(given);
  return value ? *value : "refused: " + value.error().text;
}

constexpr Option schema = {.name = "--schema",
                           .help = "which one",
                           .argument = Argument::one_of("AP242 AP214", true),
                           .preset = "AP242"};
constexpr Option lines = {.name = "-l,--lines", .help = "at most", .argument = Argument::whole(1, 100)};

}  // namespace

TEST(Argument, AValueHasOneSpelling) {
  EXPECT_EQ(canonical(Argument::positive(), "2e-3"), "0.002");
  EXPECT_EQ(canonical(Argument::positive(), "+0.0020"), "0.002");
  EXPECT_EQ(canonical(Argument::non_negative(), "0.0"), "0");
  EXPECT_EQ(canonical(Argument::whole(1, 4096), "+16"), "16");
  EXPECT_EQ(canonical(schema.argument, "ap214"), "AP214");
  EXPECT_EQ(canonical(Argument::text("FILE"), "a b"), "a b");
}

TEST(Argument, WhatIsNoValueIsRefused) {
  for (const char* text : {"", "x", "0", "-1", "nan", "inf", "1e-320", "1e999", "1 ", "0x1"})
    EXPECT_EQ(canonical(Argument::positive(), text),
              "refused: '" + std::string(text) + "' is not a positive number");
  EXPECT_EQ(canonical(Argument::non_negative(), "-1"), "refused: '-1' is not zero or a positive number");
  EXPECT_EQ(canonical(Argument::between(0.1, 30), "45"), "refused: '45' is not from 0.1 to 30");
  for (const char* text : {"", "0", "4097", "1.5", "1e3", "x", "99999999999999999999"})
    EXPECT_EQ(canonical(Argument::whole(1, 4096), text),
              "refused: '" + std::string(text) + "' is not a whole number from 1 to 4096");
  EXPECT_EQ(canonical(Argument::one_of("m cm mm"), "MM"), "refused: 'MM' is not m, cm or mm");
}

TEST(OptionValues, AreWhatWasGivenOrThePreset) {
  OptionValues values;
  EXPECT_FALSE(values.has(schema));
  EXPECT_EQ(values.text(schema), "AP242");
  EXPECT_EQ(values.whole(lines), 0);
  values.set(schema, "AP214");
  values.set(lines, "7");
  EXPECT_TRUE(values.has(schema));
  EXPECT_EQ(values.text(schema), "AP214");
  EXPECT_EQ(values.whole(lines), 7);
  EXPECT_EQ(lines.long_name(), "--lines");
  EXPECT_EQ(lines.word(), "lines");
}

}  // namespace selvage
