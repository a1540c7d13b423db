// A Fabric TXT that the grammar allows, small enough to be built and meshed at once, out of bytes that
// decide.
#pragma once

#include <string>
#include <string_view>

namespace selvage::fuzz {

// Each byte decides one thing; where they end the first choice is taken. A change of a byte changes one
// number or statement, so that a fuzzer's own mutations walk from fabric to fabric.
std::string fabric_text(std::string_view bytes);

// The same of blocks within blocks, used at other places, and of cells of repeats.
std::string placed_text(std::string_view bytes);

}  // namespace selvage::fuzz
