// What a text is told to be wrong: these errors and no others.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "formats/txt/reading.h"

namespace selvage::test {

struct Expected {
  int line, column;
  const char* text;  // a part of the message
};

inline void expect_errors(const Reading& reading, const std::vector<Expected>& expected) {
  EXPECT_FALSE(reading.fabric);
  std::vector<Message> errors;
  for (const Message& message : reading.diagnostics.messages())
    if (message.severity == Severity::error) errors.push_back(message);
  ASSERT_EQ(errors.size(), expected.size()) << reading.text();
  for (std::size_t i = 0; i < errors.size(); ++i) {
    EXPECT_EQ(errors[i].place.line, expected[i].line) << reading.text();
    EXPECT_EQ(errors[i].place.column, expected[i].column) << reading.text();
    EXPECT_NE(errors[i].text.find(expected[i].text), std::string::npos)
        << "expected: " << expected[i].text << "\n"
        << reading.text();
  }
}

}  // namespace selvage::test
