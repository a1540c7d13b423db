#include "pipeline/roundtrip.h"
#include "cli/cli.h"
#include "pipeline/batch.h"

namespace selvage::cli {

void add_roundtrip(CLI::App& program, Parsed& parsed) {
  CLI::App& command = *program.add_subcommand(
      "roundtrip", "write, read back and compare, for every surface format (exit code 3: different)");
  pipeline::Options& options = parsed.options;
  add_batch(command, parsed);
  add_ends(command, parsed);
  command.add_option("--to", options.formats,
                     "formats to go through, separated by commas (default: iges, iges-solid, step, txt)");
  command
      .add_option(
          "--tolerance", options.difference_tolerance,
          "distances up to this, in the input's unit, are no difference (default: 0, every bit counts)")
      ->check(non_negative_number());
  command.add_option("--junit", options.junit, "write the results as JUnit XML to this file");
  run_pipeline(command, parsed, pipeline::Command::roundtrip);
}

}  // namespace selvage::cli
