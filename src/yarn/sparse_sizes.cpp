#include <algorithm>
#include <cmath>

#include "yarn/size_profile.h"
#include "yarn/tube.h"

namespace selvage::yarn {

namespace {

SizeProfile profile_of(const std::vector<SizeAtParameter>& sizes, bool closed) {
  std::vector<double> at;
  std::vector<SizeProfile::Values> rows;
  for (const SizeAtParameter& size : sizes) {
    at.push_back(size.parameter);
    rows.push_back({size.size.width, size.size.height, size.angle});
  }
  return {std::move(at), std::move(rows), closed};
}

double distance(const SizeAtParameter& size, const SizeProfile::Values& values) {
  const double half = 0.5 * std::max(size.size.width, size.size.height);
  return std::max({std::abs(size.size.width - values[0]), std::abs(size.size.height - values[1]),
                   std::abs(size.angle - values[2]) * half});
}

// The middle of the extremes: what one size for all has to be.
SizeAtParameter middle_of(const std::vector<SizeAtParameter>& sizes) {
  const auto middle = [&](const auto& value) {
    const auto [low, high] = std::minmax_element(
        sizes.begin(), sizes.end(), [&](const auto& a, const auto& b) { return value(a) < value(b); });
    return 0.5 * (value(*low) + value(*high));
  };
  return {sizes.front().parameter,
          {middle([](const auto& s) { return s.size.width; }),
           middle([](const auto& s) { return s.size.height; })},
          middle([](const auto& s) { return s.angle; })};
}

}  // namespace

// Between the two ends, and then always the size in each gap that is farthest off.
std::vector<SizeAtParameter> sparse_sizes(const std::vector<SizeAtParameter>& sizes, double error,
                                          bool closed) {
  std::vector<SizeAtParameter> all;
  for (const SizeAtParameter& size : sizes)
    if (all.empty() || size.parameter > all.back().parameter) all.push_back(size);
  if (all.empty()) return all;
  std::vector<std::size_t> kept;
  std::vector<SizeAtParameter> few = {middle_of(all)};
  for (;;) {
    const SizeProfile profile = profile_of(few, closed);
    std::vector<std::size_t> added;
    std::size_t worst = 0, next = 0;
    double farthest = error;
    const auto close_gap = [&] {
      if (farthest > error) added.push_back(worst);
      farthest = error;
    };
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (next < kept.size() && i == kept[next]) {
        close_gap();
        ++next;
        continue;
      }
      const double off = distance(all[i], profile.at(all[i].parameter).value);
      if (off <= farthest) continue;
      farthest = off;
      worst = i;
    }
    close_gap();
    if (added.empty()) return few;
    if (kept.empty()) added = {0, all.size() - 1};
    kept.insert(kept.end(), added.begin(), added.end());
    std::sort(kept.begin(), kept.end());
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    few.clear();
    for (const std::size_t i : kept) few.push_back(all[i]);
  }
}

}  // namespace selvage::yarn
