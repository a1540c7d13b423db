#include "core/decimal_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

namespace selvage {
namespace {

TEST(DecimalGrid, HasTheLargestPowerOfTenThatIsAllowed) {
  EXPECT_EQ(DecimalGrid(1.0).step(), 1.0);
  EXPECT_EQ(DecimalGrid(1.83e-8).step(), 1e-8);
  EXPECT_EQ(DecimalGrid(9.99e-9).step(), 1e-9);
  EXPECT_EQ(DecimalGrid(1e-3).step(), 1e-3);
  EXPECT_EQ(DecimalGrid(std::nextafter(1e-3, 0.0)).step(), 1e-4);
  EXPECT_EQ(DecimalGrid(250.0).step(), 100.0);
}

// The C library's text of so many decimals, read again, is the same number to the bit.
TEST(DecimalGrid, GivesTheNumberThatItsDecimalTextMeans) {
  std::mt19937_64 random(16);
  for (const int decimals : {0, 3, 8, 12}) {
    const DecimalGrid grid(std::pow(10.0, -decimals) * 1.5);
    std::uniform_real_distribution<double> any(-1000.0, 1000.0);
    for (int i = 0; i < 10'000; ++i) {
      const double x = any(random), rounded = grid.rounded(x);
      char text[64];
      (void)std::snprintf(text, sizeof text, "%.*f", decimals, rounded);
      ASSERT_EQ(std::strtod(text, nullptr), rounded) << x;
      ASSERT_LE(std::abs(rounded - x), 0.5 * grid.step() * (1.0 + 1e-3) + 1e-12 * std::abs(x)) << x;
      ASSERT_EQ(grid.rounded(rounded), rounded);
    }
  }
}

TEST(DecimalGrid, LeavesNumbersWithoutDigitsBelowItsStep) {
  const DecimalGrid grid(1e-9);
  EXPECT_EQ(grid.rounded(0x1p60), 0x1p60);
  EXPECT_EQ(grid.rounded(123456789.123456789), 123456789.123456789);  // its own last digit is 1.5e-8
  EXPECT_EQ(DecimalGrid().rounded(1.0 / 3.0), 1.0 / 3.0);
  EXPECT_EQ(DecimalGrid().reach(), 0.0);
}

TEST(DecimalGrid, HasNoNegativeZero) {
  EXPECT_FALSE(std::signbit(DecimalGrid(1e-3).rounded(-1e-9)));
}

}  // namespace
}  // namespace selvage
