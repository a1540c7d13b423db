#include "cli/cli.h"

namespace selvage::cli {

void add_check(CLI::App& program, Parsed& parsed) {
  CLI::App& command =
      *program.add_subcommand("check", "closed? valid? overlapping? within tolerance? (exit code 3: no)");
  add_common(command, parsed);
  add_ends(command, parsed);
  add_units(command, parsed, "show lengths in this unit: m, cm, mm, um, inch (default: the input's)");
  command
      .add_option("--reach", parsed.options.reach,
                  "list near contacts, too: gaps between yarns up to this, in the input's unit")
      ->check(positive_number());
  command.add_option("--gap-map", parsed.options.gap_map,
                     "write the yarns coloured by the gap to the next one to this file (.vtu)");
  run_pipeline(command, parsed, pipeline::Command::check);
}

}  // namespace selvage::cli
