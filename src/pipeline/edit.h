// `selvage edit`: one more `edit` line in a text, when the yarn can be moved so.
#pragma once

#include "pipeline/options.h"

namespace selvage::pipeline {

// Builds the yarn with the edit, and writes the text with the edit's line behind the block that makes the
// yarn and behind all edits that are there, when that succeeds; -o may name the input. Returns the program's
// exit code; messages go to standard error, and nothing is written after an error.
int edit(const Options& options);

}  // namespace selvage::pipeline
