// Drafts by the names that the trade has for them beside plain, twill, satin and basket.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "fabric/model.h"

namespace selvage::formats::txt {

// `oxford`, `basket 2x1`, `2x2`, `drill`, `taffeta`, `1/1`, `twill 2x2`, `5HS`, ...: fills the draft, and
// gives what it was understood as; empty: the name has one meaning. None: it is no such name. `text`: what
// follows `draft`.
std::optional<std::string> draft_of_trade(std::string_view text, fabric::Draft& draft);

// The trade's name, or the one that is meant by a word that is none of `draft`'s own; empty: there is none.
std::string_view near_draft_of_trade(std::string_view word);

// What to write for the name of a draft that has none here; empty: nothing is known. "write 'leno'".
std::string instead_of_draft(std::string_view text);

}  // namespace selvage::formats::txt
