// First and second derivatives against central differences.
#include "mechanics/dual.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace selvage::mechanics {
namespace {

template <class T>
T expression(const std::array<T, 3>& v) {
  using std::log;
  using std::pow;
  using std::sqrt;
  return sqrt(v[0] * v[0] + v[1] * v[2]) * log(v[1]) - pow(v[2] + 2.0, -2.5) * v[0] + 3.0 * v[1];
}

TEST(Dual, DerivativesAgreeWithCentralDifferences) {
  const std::array<double, 3> at = {0.7, 1.3, 0.4};
  std::array<Dual<3>, 3> duals;
  for (std::size_t i = 0; i < 3; ++i) duals[i] = Dual<3>::variable(i, at[i]);
  const Dual<3> value = expression(duals);
  EXPECT_DOUBLE_EQ(value.value, expression(at));
  constexpr double step = 1e-4;
  const auto shifted = [&](std::size_t i, double a, std::size_t j, double b) {
    std::array<double, 3> v = at;
    v[i] += a;
    v[j] += b;
    return expression(v);
  };
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(value.first[i], (shifted(i, step, i, 0) - shifted(i, -step, i, 0)) / (2 * step), 1e-7);
    for (std::size_t j = 0; j < 3; ++j) {
      const double second = (shifted(i, step, j, step) - shifted(i, step, j, -step) -
                             shifted(i, -step, j, step) + shifted(i, -step, j, -step)) /
                            (4 * step * step);
      EXPECT_NEAR(value.second_at(i, j), second, 1e-6);
    }
  }
}

TEST(Dual, ReciprocalAndSquareOfAProduct) {
  // (x y)^-2 at (2, 3): gradient -2 / (x^3 y^2), -2 / (x^2 y^3); mixed derivative 4 / (x^3 y^3).
  const Dual<2> x = Dual<2>::variable(0, 2.0), y = Dual<2>::variable(1, 3.0);
  const Dual<2> value = square(reciprocal(x * y));
  EXPECT_NEAR(value.value, 1.0 / 36.0, 1e-15);
  EXPECT_NEAR(value.first[0], -2.0 / 72.0, 1e-15);
  EXPECT_NEAR(value.first[1], -2.0 / 108.0, 1e-15);
  EXPECT_NEAR(value.second_at(1, 0), 4.0 / 216.0, 1e-15);
}

}  // namespace
}  // namespace selvage::mechanics
