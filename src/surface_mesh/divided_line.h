// A line divided by a wanted spacing that changes along it.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace selvage::fem {

// Places that divide a line of this length, 0 and the length included, into parts about `wanted(along)` long,
// at least `least` of them.
template <class Wanted>
std::vector<double> divided_line(double length, const Wanted& wanted, int least) {
  std::vector<double> at = {0}, steps = {0};  // steps of the wanted spacing up to each place
  double before = wanted(0.0);
  while (at.back() < length) {
    const double next = std::min(length, at.back() + std::min(0.25 * before, length / 16));
    const double after = wanted(next);
    steps.push_back(steps.back() + 2 * (next - at.back()) / (before + after));
    at.push_back(next);
    before = after;
  }
  const int count = std::max(least, static_cast<int>(std::ceil(steps.back() - 0.2)));
  std::vector<double> result = {0};
  std::size_t k = 1;
  for (int i = 1; i < count; ++i) {
    const double target = steps.back() * i / count;
    while (k + 1 < steps.size() && steps[k] < target) ++k;
    const double share = (target - steps[k - 1]) / (steps[k] - steps[k - 1]);
    result.push_back(at[k - 1] + share * (at[k] - at[k - 1]));
  }
  result.push_back(length);
  return result;
}

// Places within such a line, increasing, whose first and last part have lengths of their own (0: as wanted)
// where there is room for them; in between at least `least` parts.
template <class Wanted>
std::vector<double> divided_between(double length, const Wanted& wanted, double first, double last,
                                    int least) {
  if (first + last > length / 2) first = last = 0;
  std::vector<double> places = divided_line(
      length - first - last, [&](double along) { return wanted(first + along); }, least);
  for (double& place : places) place += first;
  if (last == 0) places.pop_back();
  if (first == 0) places.erase(places.begin());
  return places;
}

}  // namespace selvage::fem
