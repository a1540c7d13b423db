// Congruence classes of the crossings of a woven repeat, by colour refinement: crossings of one class have
// neighbours of the same classes in every direction. Source: B. Weisfeiler, A. Leman, 1968 (colour
// refinement; here of a grid whose directions are told apart).
#pragma once

#include <cstddef>
#include <vector>

namespace selvage::mechanics {

struct Partition {
  std::vector<int> class_of;         // of each crossing, rows (picks) x columns (ends)
  std::vector<int> representatives;  // of each class, the first crossing
  std::vector<int> sizes;            // of each class, the number of its crossings
  bool is_exact = true;              // refining it gives no more classes
  [[nodiscard]] int count() const { return static_cast<int>(sizes.size()); }
};

// Classes numbered by their first crossing; `colors`: of each crossing, any numbers.
Partition partition_by(const std::vector<int>& colors);
// One round: crossings of a class have left, right, lower and upper neighbours (the grid is periodic) of the
// same classes, too.
Partition refined(const Partition& partition, int rows, int columns);
// Rounds until nothing changes, or until the next one has more than max_classes: the last is not exact then.
Partition stable_partition(const std::vector<int>& colors, int rows, int columns, int max_classes);

}  // namespace selvage::mechanics
