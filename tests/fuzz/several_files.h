// Inputs of several files, as one run of bytes: parts between lines "===".
#pragma once

#include <string_view>
#include <vector>

namespace selvage::fuzz {

// At most `count`; what follows is the last one's. Missing ones are empty.
std::vector<std::string_view> parts_of(std::string_view bytes, std::size_t count);

// A text that uses other files: a.txt, b.txt, c.wif, d.csv, beside each other in a folder of memory.
void run_use(std::string_view bytes);

// Results of a solver, and the deck that they are of.
void run_results(std::string_view bytes);

}  // namespace selvage::fuzz
