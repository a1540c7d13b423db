// The program's version and those of the libraries that it was built with (their modules need not be opened
// for it).
#pragma once

#include <string_view>
#include <utility>
#include <vector>

namespace selvage::pipeline {

std::string_view version();
// 16 hexadecimal digits of the sources that the program was built from: the same on every machine, another
// one for every program that may write other bytes.
std::string_view build_identity();
// {"occt", "7.6.3"}, ...: without those whose headers do not tell.
std::vector<std::pair<std::string_view, std::string_view>> library_versions();

}  // namespace selvage::pipeline
