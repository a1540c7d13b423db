#include "core/number_text.h"

#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>

namespace selvage {

namespace {

std::uint64_t bits_of(double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

}  // namespace

// The C library's strtod is the independent reader.
TEST(NumberText, ReadsBackToTheSameBits) {
  std::mt19937_64 engine(7);
  for (int i = 0; i < 200000; ++i) {
    const std::uint64_t bits = engine();
    double value = 0.0;
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;
    const std::string text = number_text(value);
    ASSERT_EQ(bits_of(std::strtod(text.c_str(), nullptr)), bits) << text;
    ASSERT_LE(text.size(), max_number_length);
  }
}

TEST(NumberText, Edges) {
  using Limits = std::numeric_limits<double>;
  for (double value : {0.0, -0.0, Limits::min(), Limits::max(), -Limits::max(), Limits::denorm_min(),
                       -Limits::denorm_min(), 0.1, 1.0 / 3.0, 2.2250738585072011e-308}) {
    const std::string text = number_text(value);
    EXPECT_EQ(bits_of(std::strtod(text.c_str(), nullptr)), bits_of(value)) << text;
    EXPECT_LE(text.size(), max_number_length);
  }
}

// The standard library's shortest form, by another algorithm (Ryu).
TEST(NumberText, HasTheCharactersOfToChars) {
  const auto expect_same = [](double value) {
    char buffer[64];
    const std::string standard(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
    ASSERT_EQ(number_text(value), standard);
  };
  std::mt19937_64 engine(11);
  std::uniform_real_distribution<double> exponent(-8.0, 18.0);
  for (int i = 0; i < 1000000; ++i) {
    const double value = std::pow(10.0, exponent(engine)) * (i % 2 == 0 ? 1.0 : -1.0);
    expect_same(value);
    // Few digits: rounded to as many places as a person would write.
    const double scale = std::pow(10.0, i % 9);
    expect_same(std::round(value * scale) / scale);
    expect_same(std::round(value));
  }
  for (int power = -7; power < 18; ++power)
    for (double digit : {1.0, 9.0, 12.0, 123456.0}) {
      const double value = digit * std::pow(10.0, power);
      expect_same(value);
      expect_same(std::nextafter(value, 0.0));
      expect_same(std::nextafter(value, 1e300));
    }
}

TEST(NumberText, IsTheShortest) {
  EXPECT_EQ(number_text(0.1), "0.1");
  EXPECT_EQ(number_text(-2.5), "-2.5");
  EXPECT_EQ(number_text(1e300), "1e+300");
  EXPECT_EQ(number_text(3.0), "3");
  EXPECT_EQ(number_text(0.1 + 0.2), "0.30000000000000004");
}

TEST(NumberText, ReadsWhatIsANumberAsAWhole) {
  EXPECT_EQ(read_number("-2.50"), -2.5);
  EXPECT_EQ(read_number("+.25"), 0.25);
  EXPECT_EQ(read_number("1e-3"), 0.001);
  for (const char* text :
       {"", "+", "+-1", "-+1", " 1", "1 ", "1,5", "0x10", "nan", "inf", "1e999", "1.2.3", "one"})
    EXPECT_FALSE(read_number(text)) << text;
}

TEST(NumberText, Integers) {
  char buffer[max_number_length];
  for (long long value :
       {0LL, -7LL, std::numeric_limits<long long>::max(), std::numeric_limits<long long>::min()})
    EXPECT_EQ(std::string(buffer, write_number(buffer, value)), std::to_string(value));
}

}  // namespace selvage
