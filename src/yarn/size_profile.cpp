#include "yarn/size_profile.h"

#include <algorithm>
#include <cstddef>

namespace selvage::yarn {

SizeProfile::SizeProfile(std::vector<double> parameters, std::vector<Values> rows, bool closed)
    : parameters_(std::move(parameters)), rows_(std::move(rows)) {
  if (closed && rows_.size() > 1) {  // two rows of the neighbouring periods on either side
    const std::size_t n = rows_.size();
    std::vector<double> t;
    std::vector<Values> r;
    for (std::size_t i = n - 2; i < n; ++i) {
      t.push_back(parameters_[i] - 1.0);
      r.push_back(rows_[i]);
    }
    t.insert(t.end(), parameters_.begin(), parameters_.end());
    r.insert(r.end(), rows_.begin(), rows_.end());
    for (std::size_t i = 0; i < 2; ++i) {
      t.push_back(parameters_[i] + 1.0);
      r.push_back(rows_[i]);
    }
    parameters_ = std::move(t);
    rows_ = std::move(r);
  }
  const std::size_t n = rows_.size();
  slopes_.assign(n, Values{0.0, 0.0, 0.0});
  for (std::size_t c = 0; c < 3; ++c) {
    const auto step = [&](std::size_t i) { return parameters_[i + 1] - parameters_[i]; };
    const auto secant = [&](std::size_t i) { return (rows_[i + 1][c] - rows_[i][c]) / step(i); };
    for (std::size_t i = 1; i + 1 < n; ++i) {
      const double d0 = secant(i - 1), d1 = secant(i);
      if (d0 * d1 <= 0.0) continue;  // a turning point: level
      const double w0 = 2.0 * step(i) + step(i - 1), w1 = step(i) + 2.0 * step(i - 1);
      slopes_[i][c] = (w0 + w1) / (w0 / d0 + w1 / d1);
    }
    if (n == 2) slopes_[0][c] = slopes_[1][c] = secant(0);
    if (n > 2) {  // one-sided parabola, kept monotone
      const auto end = [&](double h0, double h1, double d0, double d1) {
        double slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
        if (slope * d0 <= 0.0)
          slope = 0.0;
        else if (d0 * d1 <= 0.0 && std::abs(slope) > 3.0 * std::abs(d0))
          slope = 3.0 * d0;
        return slope;
      };
      slopes_[0][c] = end(step(0), step(1), secant(0), secant(1));
      slopes_[n - 1][c] = end(step(n - 2), step(n - 3), secant(n - 2), secant(n - 3));
    }
  }
}

SizeProfile::Jet SizeProfile::at(double t) const {
  Jet jet{rows_.front(), {0.0, 0.0, 0.0}};
  if (rows_.size() == 1 || t <= parameters_.front()) return jet;
  if (t >= parameters_.back()) return {rows_.back(), {0.0, 0.0, 0.0}};
  const auto after = std::upper_bound(parameters_.begin(), parameters_.end(), t);
  const auto i = static_cast<std::size_t>(after - parameters_.begin()) - 1;
  const double h = parameters_[i + 1] - parameters_[i], s = (t - parameters_[i]) / h;
  for (std::size_t c = 0; c < 3; ++c) {  // cubic Hermite
    const double y0 = rows_[i][c], y1 = rows_[i + 1][c], m0 = h * slopes_[i][c], m1 = h * slopes_[i + 1][c];
    const double a = 2.0 * (y0 - y1) + m0 + m1, b = -3.0 * (y0 - y1) - 2.0 * m0 - m1;
    jet.value[c] = ((a * s + b) * s + m0) * s + y0;
    jet.slope[c] = ((3.0 * a * s + 2.0 * b) * s + m0) / h;
  }
  return jet;
}

}  // namespace selvage::yarn
