#include "core/units.h"

#include <gtest/gtest.h>

#include <set>

namespace selvage {

TEST(Units, WordsNameThem) {
  std::set<std::string_view> names;
  for (Unit unit : all_units) EXPECT_TRUE(names.insert(name_of(unit)).second);
  EXPECT_EQ(name_of(Unit::inch), "inch");
}

TEST(Units, Millimetres) {
  EXPECT_EQ(millimetres_per(Unit::mm), 1.0);
  EXPECT_EQ(millimetres_per(Unit::um), 0.001);
  EXPECT_EQ(millimetres_per(Unit::inch), 25.4);
  EXPECT_EQ(millimetres_per(Unit::m), 1000.0 * millimetres_per(Unit::mm));
  EXPECT_EQ(millimetres_per(Unit::m), 100.0 * millimetres_per(Unit::cm));
  EXPECT_DOUBLE_EQ(millimetres_per(Unit::mm), 1000.0 * millimetres_per(Unit::um));
}

}  // namespace selvage
