#include "cli/cli.h"

namespace selvage::cli {

void add_mesh(CLI::App& program, Parsed& parsed) {
  CLI::App& command = *program.add_subcommand(
      "mesh", "tetrahedra in every yarn, or in a unit cell with its matrix, as a solver's input deck");
  pipeline::Options& o = parsed.options;
  add_common(command, parsed);
  add_output(command, parsed);
  add_ends(command, parsed);
  command
      .add_option("--size", o.size,
                  "wanted edge length, in the input's unit (default: a quarter of the thinnest section)")
      ->check(positive_number());
  command
      .add_option("--order", o.order,
                  "1: four nodes, 2: ten nodes a tetrahedron (default: 1; 2 with --matrix of "
                  "a cell that is periodic along x and y only: a plate bends)")
      ->check(CLI::IsMember({1, 2}));
  command
      .add_option("--min-dihedral", o.min_dihedral,
                  "wanted smallest angle between faces of a tetrahedron, degrees, at most 30 (default: 10)")
      ->check(number_between(0.1, 30.0));
  command.add_flag("--allow-overlap", o.allow_overlap, "mesh overlapping yarns as they are, with a warning");
  add_relaxing(command, parsed, true);
  command.add_flag("--cut", o.cut, "cut yarns flush by the faces of the input's cell");
  command.add_flag("--matrix", o.matrix, "mesh the cell: its yarns, and the matrix between them");
  command.add_flag("--periodic", o.periodic,
                   "opposite faces of the cell get the same nodes, and equations between them (as its "
                   "`periodic` says; without that word along every axis that can be)");
  command
      .add_option("--voxel", o.voxels,
                  "mesh the cell with so many hexahedra along its longest side instead (always works; yarns "
                  "have stairs)")
      ->check(CLI::Range(1, 10'000));
  command
      .add_option("--yarn-stiffness", parsed.yarn_stiffness,
                  "given: a yarn's material is the yarn's; chamis: it is its fibres', and the yarn's follows "
                  "from the local fibre fraction by Chamis's formulas (default: given)")
      ->check(CLI::IsMember({"given", "chamis"}));
  command.add_option("--segments", o.segments, "of a cell: so many edges go round each yarn, thin or thick")
      ->check(CLI::Range(6, 10'000));
  command
      .add_option("--matrix-size", o.matrix_size,
                  "with --matrix: to which edges may grow away from the yarns, in the input's unit (default: "
                  "--size)")
      ->check(positive_number());
  command.add_flag(
      "--bond", o.bond,
      "with --matrix: yarns in contact share faces (what lies between yarns nearer than 1.5 times the "
      "gap becomes part of them), instead of a gap filled with matrix");
  command.add_flag(
      "--force", o.force,
      "go on where the estimate says more than 10^8 tetrahedra, or yarns nearly touch each other or a face");
  run_pipeline(command, parsed, pipeline::Command::mesh);
}

}  // namespace selvage::cli
