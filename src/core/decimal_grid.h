// Numbers of few digits: lengths that were computed are brought to a decimal grid far finer than their
// tolerance, so that texts of them are short and still the same numbers.
#pragma once

#include <cmath>

#include "core/vec.h"

namespace selvage {

class DecimalGrid {
 public:
  // Of no step: every number stands on it.
  DecimalGrid() = default;
  // The step is the largest power of ten that is not above `most` (> 0).
  explicit DecimalGrid(double most) : exponent_(std::floor(std::log10(most))) {
    if (std::pow(10.0, exponent_) > most) --exponent_;  // the logarithm was rounded up
    is_exact_ = false;
  }

  [[nodiscard]] double step() const { return is_exact_ ? 0.0 : std::pow(10.0, exponent_); }
  // How far a point is moved at most.
  [[nodiscard]] double reach() const { return 0.5 * std::sqrt(3.0) * step(); }

  // The nearest number of the grid, to the bit the one that its decimal text means. Numbers without a digit
  // below the step are their own.
  [[nodiscard]] double rounded(double x) const {
    if (is_exact_) return x;
    const double power = std::pow(10.0, std::abs(exponent_));  // exact up to 10^22
    const double steps = std::round(exponent_ < 0.0 ? x * power : x / power);
    if (!(std::abs(steps) < 0x1p53) || power > 1e22) return x;
    return (exponent_ < 0.0 ? steps / power : steps * power) + 0.0;  // never a negative zero
  }
  [[nodiscard]] Vec3 rounded(const Vec3& p) const { return {rounded(p.x()), rounded(p.y()), rounded(p.z())}; }

 private:
  bool is_exact_ = true;
  double exponent_ = 0;
};

}  // namespace selvage
