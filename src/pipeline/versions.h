// The program's version and those of the libraries that it was built with (their modules need not be opened
// for it).
#pragma once

#include <string_view>
#include <utility>
#include <vector>

namespace selvage::pipeline {

std::string_view version();
// {"occt", "7.6.3"}, ...: without those whose headers do not tell.
std::vector<std::pair<std::string_view, std::string_view>> library_versions();

}  // namespace selvage::pipeline
