#include "core/readable.h"

#include <gtest/gtest.h>

#include "core/diagnostics.h"

namespace selvage {

// What a terminal obeys or a reader is misled by; the code points are those of Unicode's charts.
TEST(Readable, ControlsAreEscaped) {
  EXPECT_EQ(readable("a\x1B[31mb"), "a\\x1B[31mb");
  EXPECT_EQ(readable("a\nb\tc\rd\x7F"), "a\\nb\\tc\\rd\\x7F");
  EXPECT_EQ(readable(std::string_view("\0", 1)), "\\x00");
  EXPECT_EQ(readable("\xC2\x9B"), "\\x9B");  // CSI of C1
  EXPECT_EQ(readable("\xC2\x80\xC2\x9F"), "\\x80\\x9F");
  EXPECT_EQ(readable("\xE2\x80\xAE"
                     "gpj.exe"),
            "\\u202Egpj.exe");  // right to left from here
  EXPECT_EQ(readable("\xE2\x81\xA6\xE2\x81\xA9\xE2\x80\x8F\xD8\x9C"), "\\u2066\\u2069\\u200F\\u061C");
  EXPECT_EQ(readable("\xE2\x80\xA8\xE2\x80\xA9"), "\\u2028\\u2029");
}

TEST(Readable, BytesThatAreNoTextAreEscaped) {
  EXPECT_EQ(readable("\xFF"), "\\xFF");
  EXPECT_EQ(readable("a\xE2\x80"), "a\\xE2\\x80");
  EXPECT_EQ(readable("\xC0\xAF\xED\xA0\x80"), "\\xC0\\xAF\\xED\\xA0\\x80");  // overlong, a surrogate
}

TEST(Readable, TheRestStays) {
  const std::string text = "K\xC3\xB6per 2/1, \xE7\xB6\xBE \xF0\x9F\xA7\xB6 a\\b 'x' \xC2\xA0 \xE2\x80\xA6";
  EXPECT_EQ(readable(text), text);
  EXPECT_EQ(readable(readable("\x1B")), "\\x1B");
}

TEST(Readable, LongTextIsShortened) {
  EXPECT_EQ(shortened(std::string(48, 'a')), std::string(48, 'a'));
  EXPECT_EQ(shortened(std::string(10000, 'a')), std::string(45, 'a').append("..."));
  std::string umlauts;
  for (int i = 0; i < 60; ++i) umlauts += "\xC3\xB6";
  EXPECT_EQ(shortened(umlauts.substr(0, 96)), umlauts.substr(0, 96));
  EXPECT_EQ(shortened(umlauts), umlauts.substr(0, 90) + "...");
  EXPECT_EQ(columns_of(shortened(umlauts)), 48U);
  EXPECT_EQ(shortened("\x1B\x1B\x1B", 9), "\\x1B\\x...");
  EXPECT_EQ(shortened("", 3), "");
}

TEST(Readable, MessagesAre) {
  Message message = error(Kind::io, "no '\x1B[2J'\nhere");
  message.file = "a\nb";
  message.yarn = std::string(10000, 'y');
  EXPECT_EQ(to_string(message),
            "a\\nb: error: no '\\x1B[2J'\\nhere (yarn '" + std::string(45, 'y') + "...')");
}

}  // namespace selvage
