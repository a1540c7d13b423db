#include "cli/cli.h"

namespace selvage::cli {

void add_relaxing(CLI::App& command, Parsed& parsed, bool with_flag) {
  pipeline::RelaxSettings& relaxing = parsed.options.relaxing;
  if (with_flag)
    command.add_flag("--relax", relaxing.wanted,
                     "first move and reshape yarns until none overlap (exit code 3: no solution)");
  const std::string with = with_flag ? "with --relax: " : "";
  command
      .add_option("--gap", relaxing.gap,
                  with_flag
                      ? "with --relax, and in a unit cell: the least gap between yarns, in the input's unit "
                        "(default: 1 % of the smaller thickness; in a cell that is meshed 5 %)"
                      : "the least gap between yarns, in the input's unit (default: 1 % of the smaller "
                        "thickness)")
      ->check(non_negative_number());
  command
      .add_option("--overlap", relaxing.overlap,
                  with + "let yarns that meet overlap to this depth, and bring them to it, instead of a gap")
      ->check(positive_number());
  command.add_flag("--stiff-section", relaxing.stiff_section,
                   with + "sections keep their shape, only centre lines move");
  command.add_option("--max-iterations", relaxing.max_iterations, with + "give up after so many steps")
      ->check(CLI::Range(1, 1'000'000));
}

void add_relax(CLI::App& program, Parsed& parsed) {
  CLI::App& command = *program.add_subcommand(
      "relax", "move and reshape yarns until none overlap (exit code 3: no solution)");
  add_common(command, parsed);
  add_output(command, parsed);
  add_ends(command, parsed);
  add_units(command, parsed,
            "write surfaces in this unit: m, cm, mm, um, inch (default: the input's, which costs no bits)");
  add_relaxing(command, parsed, false);
  add_surfaces(command, parsed);
  run_pipeline(command, parsed, pipeline::Command::relax);
}

}  // namespace selvage::cli
