// The rewriting of OpenCASCADE's text: same content, exact shortest reals, whole strings, short lines.
#include "formats/step/stream.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <random>

namespace selvage {
namespace {

std::string rewritten(const std::string& text) {
  Result<OutputFile> output = OutputFile::in_memory();
  EXPECT_TRUE(output.ok());
  formats::step::StepStream buffer(*output);
  std::ostream stream(&buffer);
  for (std::size_t from = 0; from < text.size();) {  // line by line, as OpenCASCADE does
    const std::size_t end = std::min(text.find('\n', from), text.size() - 1) + 1;
    stream << text.substr(from, end - from) << std::flush;
    from = end;
  }
  EXPECT_TRUE(buffer.close().ok());
  return output->contents().value();
}

std::string printed(double value) {
  char text[64];
  std::snprintf(text, sizeof text, "%a", value);
  return text;
}

TEST(StepStream, RealsAreShortestAndHaveAPoint) {
  const std::pair<double, const char*> cases[] = {
      {0.0, "0."},           {1.0, "1."},      {-0.1, "-0.1"},        {1e-7, "1.E-07"},
      {1.5e300, "1.5E+300"}, {1e22, "1.E+22"}, {-2.5e-5, "-2.5E-05"}, {1.0 / 3, "0.3333333333333333"}};
  for (const auto& [value, expected] : cases)
    EXPECT_EQ(rewritten("#1 = X(" + printed(value) + ");\n"), "#1 = X(" + std::string(expected) + ");\n");
}

TEST(StepStream, IntegersNamesAndEnumerationsStay) {
  const std::string text = "#12 = AXIS2_PLACEMENT_3D('',2,-3,(3,1,1,3),.UNSPECIFIED.,.F.,$,*,#4);\n";
  EXPECT_EQ(rewritten(text), text);
}

// OpenCASCADE doubles a backslash, and may fold a line between the two.
TEST(StepStream, BackslashesAreCodes) {
  EXPECT_EQ(rewritten("#1 = P('a\\\\X2\\\\0041\\\\X0\\\\b');\n"),
            "#1 = P('a\\X2\\005C\\X0\\X2\\X2\\005C\\X0\\0041\\X2\\005C\\X0\\X0\\X2\\005C\\X0\\b');\n");
  EXPECT_EQ(rewritten("#1 = P('a\\\n\\b');\n"), "#1 = P('a\\X2\\005C\\X0\\b');\n");
  EXPECT_EQ(rewritten("#1 = P('a\\X\\09b');\n"), "#1 = P('a\\X\\09b');\n");
}

TEST(StepStream, StringsAreNotTouchedButUnfolded) {
  EXPECT_EQ(rewritten("#1 = P('0x1p+0 -0x1p-1 it''s .T. #7',0x1p+1);\n"),
            "#1 = P('0x1p+0 -0x1p-1 it''s .T. #7',2.);\n");
  EXPECT_EQ(rewritten("#1 = P('a folded \nstring',\n  0x1p+1);\n"), "#1 = P('a folded string',2.);\n");
}

TEST(StepStream, OtherAlphabetsAreEncoded) {
  EXPECT_EQ(rewritten("#1 = P('\xC3\xBC');\n"), "#1 = P('\\X2\\00FC\\X0\\');\n");
  EXPECT_EQ(rewritten("#1 = P('\xC3\n\xBC');\n"),
            "#1 = P('\\X2\\00FC\\X0\\');\n");  // folded inside a character
  EXPECT_EQ(rewritten("#1 = P('\xF0\x9F\xA7\xB5!');\n"), "#1 = P('\\X4\\0001F9F5\\X0\\!');\n");
  EXPECT_EQ(rewritten("#1 = P('\xFC');\n"), "#1 = P('\\X2\\00FC\\X0\\');\n");  // Latin-1
}

// More than the block of a MiB, folded at arbitrary places: the content is the same wherever a block ends.
TEST(StepStream, LargeTextsAcrossBlocks) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> mantissa(-1, 1);
  std::uniform_int_distribution<int> exponent(-300, 300), choice(0, 3), length(0, 120);
  std::string text, expected;
  for (int i = 1; text.size() < 5'000'000; ++i) {
    const std::string head = "#" + std::to_string(i) + "=POINT('";
    text += head;
    expected += head;
    for (int k = length(random); k > 0; --k) {
      text += choice(random) == 0 ? "''" : "x";
      expected += text.back() == 'x' ? "x" : "''";
      if (k % 50 == 0) text += '\n';
    }
    text += "',(";
    expected += "',(";
    for (int k = 0; k < 3; ++k) {
      const double value = std::ldexp(mantissa(random), exponent(random));
      text += (k > 0 ? "," : "") + printed(value) + (choice(random) == 0 ? "\n    " : "");
      char digits[40];
      std::string real(digits, std::to_chars(digits, digits + 40, value).ptr);
      std::replace(real.begin(), real.end(), 'e', 'E');
      if (real.find('.') == std::string::npos) real.insert(std::min(real.find('E'), real.size()), ".");
      expected += (k > 0 ? "," : "") + real;
    }
    text += "));\n";
    expected += "));";
  }
  std::string result = rewritten(text);
  std::erase(result, '\n');
  std::erase(result, ' ');  // what is left of indentation where a block ended
  EXPECT_TRUE(result == expected);
}

TEST(StepStream, TheFirstRefusalIsKept) {
  Result<OutputFile> output = OutputFile::in_memory();
  ASSERT_TRUE(output.ok());
  OutputFile closed = std::move(*output);  // what is moved from has no file
  formats::step::StepStream buffer(*output);
  std::ostream stream(&buffer);
  stream << "ISO-10303-21;\n";
  EXPECT_FALSE(buffer.close().ok());
}

}  // namespace
}  // namespace selvage
