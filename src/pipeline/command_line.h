// What the program understands: its subcommands and their options. The command line's parser and its help,
// defaults, and the settings that `--resume` compares are made from their table.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"
#include "pipeline/option_table.h"

namespace selvage::pipeline {

struct Subcommand {
  Command command;
  std::string_view name, help;
  std::string_view examples;  // lines that can be typed
};
// In the order of help.
std::span<const Subcommand> all_commands();

// Those of a subcommand, in the order of help, with what the formats that it can write declare.
std::vector<const Row*> rows_of(Command command);

// What was given, as it was given, by Option::name; flags without a value.
using Given = std::map<std::string_view, std::vector<std::string>>;

// Errors (usage): a value that is none; options that do not go together; --resume without a report.
Result<Options> understand(Command command, const Given& given);

}  // namespace selvage::pipeline
