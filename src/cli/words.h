// What was perhaps meant.
#pragma once

#include <string>
#include <vector>

namespace selvage::cli {

// "; did you mean 'WORD'?"; empty: nothing known is near.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& known);

}  // namespace selvage::cli
