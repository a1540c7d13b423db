#include "mechanics/partition.h"

#include <gtest/gtest.h>

#include <numeric>

namespace selvage::mechanics {
namespace {

std::vector<int> colors(int rows, int columns, int (*color)(int row, int column)) {
  std::vector<int> made;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) made.push_back(color(row, column));
  return made;
}

TEST(Partition, PlainWeaveHasTwoClassesOfAnySize) {
  const Partition found =
      stable_partition(colors(6, 4, [](int row, int column) { return (row + column) % 2; }), 6, 4, 100);
  EXPECT_EQ(found.count(), 2);
  EXPECT_EQ(found.sizes, (std::vector<int>{12, 12}));
  EXPECT_TRUE(found.is_exact);
}

TEST(Partition, ATwillHasAClassForEachStepOfItsRepeat) {
  const Partition found = stable_partition(
      colors(4, 4, [](int row, int column) { return (column - row + 4) % 4 < 2 ? 1 : 0; }), 4, 4, 100);
  EXPECT_EQ(found.count(), 4);
  for (const int size : found.sizes) EXPECT_EQ(size, 4);
}

TEST(Partition, OneOtherCrossingTellsAllApart) {
  const Partition found = stable_partition(
      colors(5, 7, [](int row, int column) { return row == 2 && column == 3 ? 1 : 0; }), 5, 7, 100);
  EXPECT_EQ(found.count(), 35);
}

TEST(Partition, StopsBeforeTooManyClasses) {
  const Partition found = stable_partition(
      colors(5, 7, [](int row, int column) { return row == 2 && column == 3 ? 1 : 0; }), 5, 7, 10);
  EXPECT_FALSE(found.is_exact);
  EXPECT_LE(found.count(), 10);
  EXPECT_EQ(std::accumulate(found.sizes.begin(), found.sizes.end(), 0), 35);
  EXPECT_EQ(refined(found, 5, 7).count() > 10, true);
}

}  // namespace
}  // namespace selvage::mechanics
