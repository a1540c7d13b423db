#include "core/clock.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace selvage {

TEST(Clock, TimesOfTheFirstAndTheLastYear) {
  ::setenv("SOURCE_DATE_EPOCH", "0", 1);
  EXPECT_TRUE(check_clock().ok());
  EXPECT_EQ(iso_timestamp(), "1970-01-01T00:00:00");
  ::setenv("SOURCE_DATE_EPOCH", "253402300799", 1);
  EXPECT_TRUE(check_clock().ok());
  EXPECT_EQ(iges_timestamp(), "99991231.235959");
  ::unsetenv("SOURCE_DATE_EPOCH");
  EXPECT_TRUE(check_clock().ok());
}

TEST(Clock, OtherTimesAreErrors) {
  for (const char* text : {"", "x", "1e9", "1700000000 ", " 1700000000", "1700000000.5", "-1", "+1", "0x10",
                           "253402300800", "99999999999999999999", "2026-11-27"}) {
    ::setenv("SOURCE_DATE_EPOCH", text, 1);
    const Status clock = check_clock();
    ASSERT_FALSE(clock.ok()) << text;
    EXPECT_EQ(clock.error().kind, Kind::usage);
    EXPECT_NE(clock.error().text.find("SOURCE_DATE_EPOCH is '"), std::string::npos);
  }
  ::unsetenv("SOURCE_DATE_EPOCH");
}

}  // namespace selvage
