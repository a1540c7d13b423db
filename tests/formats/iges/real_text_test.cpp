// Numbers: the very bits of std::from_chars.
#include "formats/iges/real_text.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <random>
#include <string>

#include "formats/iges/records.h"

namespace selvage::test {

namespace {

using formats::iges::read_real;

// Reads all of the text; NaN where it is no number.
double read_all(const std::string& text) {
  double value = std::nan("");
  const char* const end = text.data() + text.size();
  return read_real(text.data(), end, value) == end ? value : std::nan("");
}

double from_chars(const std::string& text) {
  double value = std::nan("");
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

::testing::AssertionResult same_bits(const std::string& text) {
  const double ours = read_all(text), theirs = from_chars(text);
  if (std::bit_cast<std::uint64_t>(ours) == std::bit_cast<std::uint64_t>(theirs))
    return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << text << ": " << fmt::format("{:a} is not {:a}", ours, theirs);
}

TEST(IgesReal, EveryDoubleThatIsWrittenComesBack) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 1'000'000; ++i) {
    const double value = std::bit_cast<double>(random());
    if (!std::isfinite(value)) continue;
    char buffer[max_number_length];
    const std::string text(buffer, write_pointed(buffer, value));
    ASSERT_EQ(std::bit_cast<std::uint64_t>(read_all(text)), std::bit_cast<std::uint64_t>(value)) << text;
  }
}

// Coordinates: a few digits before the point, all of them behind it.
TEST(IgesReal, CoordinatesAsFromChars) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> place(-100, 100);
  for (int i = 0; i < 1'000'000; ++i) {
    const double value = place(random) * std::pow(10, static_cast<int>(random() % 9) - 6);
    ASSERT_TRUE(same_bits(fmt::format("{}", value)));
    ASSERT_TRUE(same_bits(fmt::format("{:.{}f}", value, random() % 20)));
  }
}

TEST(IgesReal, DigitsAndExponentsAsFromChars) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 1'000'000; ++i) {
    std::string text = random() % 2 == 0 ? "-" : "";
    const auto digits = [&](std::uint64_t most) {
      for (std::uint64_t n = random() % (most + 1); n > 0; --n)
        text += static_cast<char>('0' + random() % 10);
    };
    text += static_cast<char>('0' + random() % 10);
    digits(i % 3 == 0 ? 25 : 4);
    if (random() % 4 != 0) text += '.';
    if (text.back() == '.') digits(22);
    if (random() % 2 == 0) text += fmt::format("E{}", static_cast<int>(random() % 60) - 30);
    ASSERT_TRUE(same_bits(text));
  }
}

// The hardest cases: exactly in the middle of two doubles, and one digit beside it.
TEST(IgesReal, MiddlesBetweenDoubles) {
  std::mt19937_64 random(4);
  int checked = 0;
  for (int i = 0; i < 300'000; ++i) {
    // An odd 54-bit integer over 2^k has few digits for small k.
    const std::uint64_t middle = (std::uint64_t{1} << 53U) | (random() >> 11U) | 1U;
    ASSERT_TRUE(same_bits(fmt::format("{}", middle)));
    for (unsigned k = 1; k <= 3; ++k) {
      std::uint64_t whole = middle >> k, rest = middle & ((1U << k) - 1), scale = 1;
      for (unsigned j = 0; j < k; ++j) scale *= 5;
      const std::string text = fmt::format("{}.{:0{}}", whole, rest * scale, k);
      ASSERT_TRUE(same_bits(text));
      ASSERT_TRUE(same_bits(text + "1"));
      ++checked;
    }
    // Beside the middle in the 19th digit.
    const double low = std::ldexp(static_cast<double>(random() >> 11U), -static_cast<int>(random() % 60));
    if (low == 0) continue;
    const long double between = (static_cast<long double>(low) + std::nextafter(low, 1e300)) / 2;
    ASSERT_TRUE(same_bits(fmt::format("{:.18e}", between)));
    ASSERT_TRUE(same_bits(fmt::format("{:.17e}", between)));
  }
  EXPECT_GT(checked, 100'000);
}

TEST(IgesReal, FormsThatOnlyIgesHas) {
  EXPECT_EQ(read_all("1.5D3"), 1500);
  EXPECT_EQ(read_all("1.5d+03"), 1500);
  EXPECT_EQ(read_all("-2D-1"), -0.2);
  EXPECT_EQ(read_all("+.5"), 0.5);
  EXPECT_EQ(read_all("5."), 5);
  EXPECT_EQ(read_all("-5"), -5);
  EXPECT_EQ(read_all("123456789012345678901234567890.D0"), 123456789012345678901234567890.0);
  EXPECT_EQ(read_all("0.0000000000000000000000000000000123D0"), 1.23e-32);
  EXPECT_EQ(read_all("1E-400"), 0);
  EXPECT_TRUE(std::signbit(read_all("-1D-400")));
  EXPECT_EQ(read_all("0." + std::string(400, '0') + "1"), 0);
  EXPECT_EQ(read_all("0." + std::string(400, '0') + "1E+401"), 1);
  EXPECT_EQ(read_all("0E99999999999999999999"), 0);
  EXPECT_TRUE(std::signbit(read_all("-0.")));
}

TEST(IgesReal, NoNumbers) {
  for (const char* text :
       {"",    "-",        "+",    ".",     "-.",   "E5",  ".E5", "1E",  "1E+",  "1D-",  "NaN", "nan",
        "inf", "Infinity", "-inf", "1e400", "0x10", "1,5", "1 5", "--1", "1.5.", "1E5E", " 1",  "1 "})
    EXPECT_TRUE(std::isnan(read_all(text))) << text;
  EXPECT_TRUE(std::isnan(read_all("1" + std::string(400, '0'))));
}

// Nothing behind the end is looked at.
TEST(IgesReal, StopsAtTheEnd) {
  const std::string text = "1.23456789012345678";
  for (std::size_t length = 1; length <= text.size(); ++length) {
    double value = 0;
    const char* const end = text.data() + length;
    EXPECT_EQ(read_real(text.data(), end, value), end);
    EXPECT_EQ(value, from_chars(text.substr(0, length)));
  }
}

}  // namespace

}  // namespace selvage::test
