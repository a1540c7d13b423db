#include "mechanics/partition.h"

#include <array>
#include <map>

namespace selvage::mechanics {

namespace {

template <class Key>
Partition numbered(const std::vector<Key>& keys) {
  Partition made;
  std::map<Key, int> known;
  made.class_of.reserve(keys.size());
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const auto [at, is_new] = known.try_emplace(keys[k], made.count());
    if (is_new) {
      made.representatives.push_back(static_cast<int>(k));
      made.sizes.push_back(0);
    }
    ++made.sizes[static_cast<std::size_t>(at->second)];
    made.class_of.push_back(at->second);
  }
  return made;
}

}  // namespace

Partition partition_by(const std::vector<int>& colors) {
  return numbered(colors);
}

Partition refined(const Partition& partition, int rows, int columns) {
  std::vector<std::array<int, 5>> keys;
  keys.reserve(partition.class_of.size());
  const auto at = [&](int row, int column) {
    return partition
        .class_of[static_cast<std::size_t>((row + rows) % rows) * static_cast<std::size_t>(columns) +
                  static_cast<std::size_t>((column + columns) % columns)];
  };
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      keys.push_back({at(row, column), at(row, column - 1), at(row, column + 1), at(row - 1, column),
                      at(row + 1, column)});
  return numbered(keys);
}

Partition stable_partition(const std::vector<int>& colors, int rows, int columns, int max_classes) {
  Partition partition = partition_by(colors);
  for (;;) {
    Partition next = refined(partition, rows, columns);
    if (next.count() == partition.count()) return partition;
    if (next.count() > max_classes) {
      partition.is_exact = false;
      return partition;
    }
    partition = std::move(next);
  }
}

}  // namespace selvage::mechanics
