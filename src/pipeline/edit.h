// `selvage edit`: one more `edit` line in a text, when the yarn can be moved so.
#pragma once

#include <string>

#include "formats/format.h"
#include "pipeline/options.h"

namespace selvage::pipeline {

struct EditRequest {
  std::string input;   // a path, or "-" for standard input
  std::string output;  // -o: a file, which may be the input's, a folder, or "-" for standard output
  formats::NewEdit edit;
  Options options;  // quiet, timeout, memory, sandbox, allow_outside
};

// Builds the yarn with the edit, and writes the text with the edit's line behind the block that makes the
// yarn and behind all edits that are there, when that succeeds. Returns the program's exit code; messages go
// to standard error, and nothing is written after an error.
int edit(const EditRequest& request);

}  // namespace selvage::pipeline
