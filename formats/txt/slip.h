// What a line of a block meant that begins with none of the block's words.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace selvage::formats::txt {

// The statement that was meant by `line` in a block of the given kind ("weave"; empty: the file), whose
// statements begin with `words`: a value in front of its word (`16 carriers`), the name of a draft alone, the
// designation of a glass yarn, a density by its short form (`cpc 18`), a diameter for a radius, the block's
// own word in front (`braid angle 45`). None: it is not recognized.
std::optional<std::string> meant_line(std::string_view kind, std::string_view line,
                                      const std::vector<std::string_view>& words);

// What to write for a knit by another name (`1x1 rib`, `stockinette`, `pique`), as "write 'jersey'"; empty:
// it is not recognized.
std::string instead_of_knit(std::string_view text);

// Does the word close the block in another language: `}`, `endthread`, `end-thread`?
bool closes_elsewhere(std::string_view kind, std::string_view word);

}  // namespace selvage::formats::txt
