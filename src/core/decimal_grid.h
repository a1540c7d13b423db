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
  explicit DecimalGrid(double most) {
    double exponent = std::floor(std::log10(most));
    if (std::pow(10.0, exponent) > most) --exponent;  // the logarithm was rounded up
    step_ = std::pow(10.0, exponent);
    power_ = std::pow(10.0, std::abs(exponent));
    is_fraction_ = exponent < 0.0;
    if (power_ > 1e22) power_ = 0.0;  // no more a number of its own
  }

  [[nodiscard]] double step() const { return step_; }
  // How far a point is moved at most.
  [[nodiscard]] double reach() const { return 0.5 * std::sqrt(3.0) * step_; }

  // The nearest number of the grid, to the bit the one that its decimal text means. Numbers without a digit
  // below the step are their own.
  [[nodiscard]] double rounded(double x) const {
    if (power_ == 0.0) return x;
    const double steps = std::round(is_fraction_ ? x * power_ : x / power_);
    if (!(std::abs(steps) < 0x1p53)) return x;
    return (is_fraction_ ? steps / power_ : steps * power_) + 0.0;  // never a negative zero
  }
  [[nodiscard]] Vec3 rounded(const Vec3& p) const { return {rounded(p.x()), rounded(p.y()), rounded(p.z())}; }

  bool operator==(const DecimalGrid&) const = default;

 private:
  double step_ = 0,
         power_ = 0;  // the step or its inverse, whichever is whole; 0: every number is on the grid
  bool is_fraction_ = false;
};

}  // namespace selvage
