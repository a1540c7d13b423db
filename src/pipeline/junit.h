// The results of `selvage roundtrip` as JUnit XML, which every CI shows.
#pragma once

#include <string>
#include <vector>

namespace selvage::pipeline {

struct JunitInput {
  std::string path;
  std::string entry;  // of the report, as JSON; empty: not done
};
// One test case an input and format: a failure where the geometry came back different, an error where it did
// not come back. An input that was not reached is skipped.
std::string junit_text(const std::vector<JunitInput>& inputs, const std::string& started, double seconds);

}  // namespace selvage::pipeline
