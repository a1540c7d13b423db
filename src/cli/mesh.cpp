#include "cli/cli.h"

namespace selvage::cli {

void add_mesh(CLI::App& program, Parsed& parsed) {
  CLI::App& command = *program.add_subcommand("mesh", "tetrahedra in every yarn, as a solver's input deck");
  pipeline::Options& o = parsed.options;
  add_common(command, parsed);
  add_output(command, parsed);
  add_ends(command, parsed);
  command
      .add_option("--size", o.size,
                  "wanted edge length, in the input's unit (default: a quarter of the thinnest section)")
      ->check(CLI::PositiveNumber);
  command.add_option("--order", o.order, "1: four nodes, 2: ten nodes a tetrahedron (default: 1)")
      ->check(CLI::IsMember({1, 2}));
  command.add_option("--min-dihedral", o.min_dihedral, "wanted smallest angle between faces, degrees")
      ->check(CLI::Range(0.1, 70.0));
  command.add_flag("--allow-overlap", o.allow_overlap, "mesh overlapping yarns as they are, with a warning");
  add_relaxing(command, parsed, true);
  run_pipeline(command, parsed, pipeline::Command::mesh);
}

}  // namespace selvage::cli
