// What a line of a block meant that begins with none of the block's words.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace selvage::formats::txt {

// The line to write instead of `line`, which stands in a block of that kind ("weave") with these words: a
// value in front of its word (`16 carriers`), the name of a draft alone, the designation of a glass yarn, a
// density by its short form (`cpc 18`), a diameter for a radius, the block's own word in front (`braid angle
// 45`). None: nobody knows.
std::optional<std::string> meant_line(std::string_view kind, std::string_view line,
                                      const std::vector<std::string_view>& words);

// Does the word close the block in another language: `}`, `endthread`, `end-thread`?
bool closes_elsewhere(std::string_view kind, std::string_view word);

}  // namespace selvage::formats::txt
