// One more statement in a text that stays as it is otherwise.
#pragma once

#include <string>
#include <string_view>

#include "formats/format.h"

namespace selvage::formats::txt {

// The text with the edit's line after line `after` (from 1, the last one at most), ended as that line is;
// where that is the last line and has no end, the new one has none either. The yarn's name can be written: it
// was read.
std::string insert_edit(std::string_view bytes, int after, const NewEdit& edit);

}  // namespace selvage::formats::txt
