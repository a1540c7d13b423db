#include "core/number_text.h"

#include <gtest/gtest.h>

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

TEST(NumberText, IsTheShortest) {
  EXPECT_EQ(number_text(0.1), "0.1");
  EXPECT_EQ(number_text(-2.5), "-2.5");
  EXPECT_EQ(number_text(1e300), "1e+300");
  EXPECT_EQ(number_text(3.0), "3");
  EXPECT_EQ(number_text(0.1 + 0.2), "0.30000000000000004");
}

TEST(NumberText, Integers) {
  char buffer[max_number_length];
  for (long long value :
       {0LL, -7LL, std::numeric_limits<long long>::max(), std::numeric_limits<long long>::min()})
    EXPECT_EQ(std::string(buffer, write_number(buffer, value)), std::to_string(value));
}

}  // namespace selvage
