#include "cli/cli.h"

namespace selvage::cli {

void add_surfaces(CLI::App& command, Parsed& parsed) {
  command.add_flag("--iges-solid", parsed.options.iges_solid,
                   "IGES: a solid (186) instead of three surfaces (128) a yarn");
  command
      .add_option(
          "--iges-lines", parsed.options.iges_lines,
          "IGES: at most so many lines a section; a longer fabric is written as NAME.1.igs, NAME.2.igs, "
          "... (default: 9999999, as many as there are numbers for)")
      ->check(CLI::Range(std::int64_t{100}, std::int64_t{9'999'999}));
  command.add_flag("--split-yarns", parsed.options.split_yarns,
                   "IGES: a yarn that is too long for one file is cut into several, each closed");
  command.add_flag("--instances", parsed.options.instances,
                   "IGES, STEP: yarns that are equal up to a motion are written once and placed (not every "
                   "reader knows IGES's 308 and 408: Abaqus/CAE passes them by)");
  command.add_option("--step-schema", parsed.options.step_schema, "STEP: AP242 or AP214 (default: AP242)")
      ->check(CLI::IsMember({"AP242", "AP214"}, CLI::ignore_case));
}

void add_convert(CLI::App& program, Parsed& parsed) {
  CLI::App& command = *program.add_subcommand("convert", "write surfaces, solids or text");
  add_common(command, parsed);
  add_output(command, parsed);
  add_ends(command, parsed);
  add_units(command, parsed,
            "write surfaces in this unit: m, cm, mm, um, inch (default: the input's, which costs no bits)");
  add_surfaces(command, parsed);
  command.add_flag("--cut", parsed.options.cut,
                   "IGES, STEP: the yarns cut flush by the cell's faces, as solids");
  command.add_flag(
      "--matrix", parsed.options.matrix,
      "IGES, STEP: with them what they leave of the cell, as one solid that shares its faces with "
      "theirs (implies --cut)");
  add_relaxing(command, parsed, true);
  run_pipeline(command, parsed, pipeline::Command::convert);
}

}  // namespace selvage::cli
