#include "cli/cli.h"

namespace selvage::cli {

void add_convert(CLI::App& program, Parsed& parsed) {
  CLI::App& command = *program.add_subcommand("convert", "write surfaces, solids or text");
  add_common(command, parsed);
  add_output(command, parsed);
  add_ends(command, parsed);
  add_units(command, parsed,
            "write surfaces in this unit: m, cm, mm, um, inch (default: the input's, which costs no bits)");
  command.add_flag("--iges-solid", parsed.options.iges_solid,
                   "IGES: a solid (186) instead of three surfaces (128) a yarn");
  command.add_option("--step-schema", parsed.options.step_schema, "STEP: AP242 or AP214 (default: AP242)")
      ->check(CLI::IsMember({"AP242", "AP214"}, CLI::ignore_case));
  run_pipeline(command, parsed, pipeline::Command::convert);
}

}  // namespace selvage::cli
