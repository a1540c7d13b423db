#include "core/units.h"

#include <gtest/gtest.h>

namespace selvage {

TEST(Units, WordsNameThem) {
  for (Unit unit : all_units) EXPECT_EQ(unit_named(name_of(unit)), unit);
  EXPECT_EQ(unit_named("inch"), Unit::inch);
  EXPECT_EQ(unit_named("furlong"), std::nullopt);
  EXPECT_EQ(unit_named(""), std::nullopt);
}

TEST(Units, Millimetres) {
  EXPECT_EQ(millimetres_per(Unit::mm), 1.0);
  EXPECT_EQ(millimetres_per(Unit::inch), 25.4);
  EXPECT_EQ(millimetres_per(Unit::m), 1000.0 * millimetres_per(Unit::mm));
  EXPECT_EQ(millimetres_per(Unit::m), 100.0 * millimetres_per(Unit::cm));
  EXPECT_DOUBLE_EQ(millimetres_per(Unit::mm), 1000.0 * millimetres_per(Unit::um));
}

}  // namespace selvage
