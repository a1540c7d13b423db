#include "core/csv.h"

#include <gtest/gtest.h>

#include <array>

namespace selvage {

TEST(Csv, AFormulaBecomesAText) {
  for (const std::string value : {"=1+1", "+A1", "-A1", "@SUM(1)", "\tx", "\rx", "\nx", "-", "=\"a\",b",
                                  "'=1", "''-x", "-0.9mm", "+inf", "-nan"}) {
    const std::string cell = csv_value(value);
    EXPECT_TRUE(cell.starts_with("\"'")) << cell;
    const Result<CsvTable> table = read_csv("a,b\n" + cell + ",1\n");
    ASSERT_TRUE(table.ok()) << value;
    EXPECT_EQ(table->rows, (std::vector<std::vector<std::string>>{{value, "1"}}));
  }
}

TEST(Csv, OtherValuesStayAsTheyAre) {
  for (const char* value : {"-1", "+2.5", "-1e-3", ".5", "0", "a=b", "a-b", "'quoted'", "", "'"}) {
    EXPECT_EQ(csv_value(value), value);
    const Result<CsvTable> table = read_csv("a,b\n" + csv_value(value) + ",1\n");
    ASSERT_TRUE(table.ok());
    EXPECT_EQ(table->rows.front().front(), value);
  }
  EXPECT_EQ(csv_value("a,b"), "\"a,b\"");
}

TEST(Csv, AMarkOfAnotherProgramIsTaken) {
  const Result<CsvTable> table = read_csv("'=a,b\n'-x,'+y\n");
  ASSERT_TRUE(table.ok());
  EXPECT_EQ(table->columns, (std::vector<std::string>{"=a", "b"}));
  EXPECT_EQ(table->rows.front(), (std::vector<std::string>{"-x", "+y"}));
}

// By a search of all columns for each this would take hours.
TEST(Csv, ManyColumns) {
  std::string head = "c0";
  for (int k = 1; k < 1'000'000; ++k) head += ",c" + std::to_string(k);
  EXPECT_EQ(read_csv(head + "\n")->columns.size(), 1'000'000U);
  const Result<CsvTable> twice = read_csv(head + ",c7\n");
  ASSERT_FALSE(twice.ok());
  EXPECT_EQ(twice.error().text, "the column 'c7' is there twice");
}

}  // namespace selvage
