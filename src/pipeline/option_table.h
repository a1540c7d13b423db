// All options of the program, in one table.
#pragma once

#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "core/option.h"
#include "pipeline/options.h"

namespace selvage::pipeline {

// An option of some subcommands. Several rows may have one name, for different ones.
struct Row {
  std::vector<Command> commands;
  Option option;
  // Puts a value, as Argument::canonical() gives it, where it belongs; error (usage): it is none. Null: it is
  // a format's own.
  std::function<Status(Options&, const std::string&)> take;
  std::string group{};  // its heading in help
};

// In the order of help, with what the formats declare for themselves.
const std::deque<Row>& all_rows();

}  // namespace selvage::pipeline
