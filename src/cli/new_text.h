// `selvage new`: texts to begin with.
#pragma once

#include <string>

#include "core/diagnostics.h"

namespace selvage::cli {

// Of this kind; empty: a table of the kinds. Error (usage): there is no such kind.
Result<std::string> text_of_kind(const std::string& kind);

// Writes a text to a file that is not there yet. Errors (io): it is there, or cannot be written.
Status write_new_file(const std::string& path, const std::string& text);

}  // namespace selvage::cli
