#include "cli/cli.h"

namespace selvage::cli {

void add_info(CLI::App& program, Parsed& parsed) {
  CLI::App& command = *program.add_subcommand("info", "what is in a file: yarns, sizes, units, lengths");
  add_common(command, parsed);
  add_ends(command, parsed);
  add_units(command, parsed, "show lengths in this unit: m, cm, mm, um, inch (default: the input's)");
  command.add_flag("--json", parsed.options.json, "print the JSON report instead of tables");
  command.add_flag("--table", parsed.options.table,
                   "garment curves: each fixed point's error, and the control points by both methods");
  run_pipeline(command, parsed, pipeline::Command::info);
}

}  // namespace selvage::cli
