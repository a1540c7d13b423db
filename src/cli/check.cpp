#include "cli/cli.h"

namespace selvage::cli {

void add_check(CLI::App& program, Parsed& parsed) {
  CLI::App& command =
      *program.add_subcommand("check", "closed? valid? overlapping? within tolerance? (exit code 3: no)");
  add_common(command, parsed);
  add_ends(command, parsed);
  add_units(command, parsed, "show lengths in this unit: m, cm, mm, um, inch (default: the input's)");
  run_pipeline(command, parsed, pipeline::Command::check);
}

}  // namespace selvage::cli
