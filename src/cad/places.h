// A spatial hash: what lies round a place, among things of like size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "cad/sampled_curve.h"

namespace selvage::cad {

class Places {
 public:
  void add(const Polylines& outline, std::size_t id);
  // The ids of those whose box may be this one's: centres within a quarter of the diagonal, diagonals within
  // a factor of four; sorted.
  [[nodiscard]] std::vector<std::size_t> near(const Polylines& outline) const;

 private:
  struct Entry {
    Box3 box;
    std::size_t id;
  };
  std::unordered_map<std::uint64_t, std::vector<Entry>> cells_;
};

}  // namespace selvage::cad
