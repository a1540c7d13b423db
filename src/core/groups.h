// Numbers that are joined into groups, one pair after the other (union-find).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace selvage {

class Groups {
 public:
  // Each of 0 .. count - 1 for itself; less than 2^32 of them.
  explicit Groups(std::size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0U); }

  // The least number of the group that holds `number`: its name.
  [[nodiscard]] std::uint32_t of(std::size_t number) {
    auto k = static_cast<std::uint32_t>(number);
    while (parents_[k] != k) k = parents_[k] = parents_[parents_[k]];
    return k;
  }

  // False: they are in one group already.
  bool join(std::size_t a, std::size_t b) {
    const auto [least, other] = std::minmax({of(a), of(b)});
    parents_[other] = least;
    return least != other;
  }

 private:
  std::vector<std::uint32_t> parents_;
};

}  // namespace selvage
