#include "cli/cli.h"
#include "pipeline/batch.h"

namespace selvage::cli {

void add_diff(CLI::App& program, Parsed& parsed) {
  CLI::App& command =
      *program.add_subcommand("diff", "compare the geometry of two files (exit code 3: they differ)");
  pipeline::DiffRequest& request = parsed.diff;
  command.add_option("A", request.a, "a file of any readable format, or - for standard input")->required();
  command.add_option("B", request.b, "another one, of the same or another format")->required();
  command
      .add_option("--tolerance", request.tolerance,
                  "distances up to this, in A's unit, are no difference (default: 0, every bit counts)")
      ->check(non_negative_number());
  command.add_flag("--json", request.json, "one JSON object instead of lines");
  command.add_flag("--all", request.all, "every difference (default: the first 20 and a count)");
  add_running(command, parsed, request.options);
  command.callback([&parsed] {
    parsed.action = [&parsed] {
      if (Status status = complete(parsed, parsed.diff.options); !status)
        return pipeline::refuse(status.error());
      if (parsed.diff.a == "-" && parsed.diff.b == "-")
        return pipeline::refuse(error(Kind::usage, "standard input can be only one of the two"));
      return pipeline::diff(parsed.diff);
    };
  });
}

}  // namespace selvage::cli
