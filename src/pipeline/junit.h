// The results of `selvage check`, `roundtrip` and `diff` as JUnit XML, which every CI shows.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace selvage::pipeline {

struct JunitInput {
  std::string path;
  std::string entry;  // of the report, as JSON; empty: not done
};
// Of `check` one test case an input: a failure where it has defects, an error where it cannot be read or
// built. Of `roundtrip` one test case an input and format: a failure where the geometry came back different,
// an error where it did not come back. Of `diff` one a yarn, part or curve: a failure where it differs, an
// error where a file cannot be read. An input that was not reached is skipped.
std::string junit_text(std::string_view command, const std::vector<JunitInput>& inputs,
                       const std::string& started, double seconds);

}  // namespace selvage::pipeline
