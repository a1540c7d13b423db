// The command line as words, by the table of pipeline/command_line.h.
#pragma once

#include <string>

#include "core/diagnostics.h"
#include "pipeline/options.h"

namespace selvage::cli {

struct Parsed {
  std::string text;  // help or the version, where that was asked for; else empty
  pipeline::Options options;
};

// Errors (usage): words that are unknown, missing or too many, with what was perhaps meant; values that are
// none; options that do not go together.
Result<Parsed> parse(int count, char** words);

}  // namespace selvage::cli
