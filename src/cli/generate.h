// `selvage --generate`: what other programs read of the tables of commands, options, formats and words.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"
#include "pipeline/command_line.h"

namespace selvage::cli {

// "man", "complete-bash", ...
std::vector<std::string_view> generated_forms();
// Error (usage): there is no such form.
Result<std::string> generate(std::string_view form);

// manual.cpp: the manual page, in the man macros of roff.
std::string manual_page();
// completion.cpp: of shells.
std::string bash_completion();
std::string zsh_completion();
std::string fish_completion();

// --- for these
// "-o,--output" by its parts.
std::vector<std::string_view> names_of(const Option& option);
// "NAME", "FILE ...", "{a,b}" as in help; empty of flags.
std::string argument_of(const Option& option);
// Each option of the table once, with its subcommands, by its heading in the order of help.
struct Group {
  std::string heading;
  std::vector<const pipeline::Row*> rows;
};
std::vector<Group> all_groups();

// What may stand behind an option or at a place: these words, these files, or both.
struct Expected {
  std::vector<std::string> words;
  bool is_list = false;  // several words, by commas
  bool takes_files = false;
  bool takes_inputs = false;  // files of formats that can be read
};
Expected expected(pipeline::Command command, const Option& option);
// ".txt", ...: of formats that can be read.
std::vector<std::string_view> readable_extensions();

}  // namespace selvage::cli
