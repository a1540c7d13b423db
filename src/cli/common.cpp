#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>

#include "cli/cli.h"
#include "core/standard_output.h"
#include "pipeline/batch.h"
#include "pipeline/limits.h"

namespace selvage::cli {

namespace {

constexpr std::array<std::string_view, 1> later_commands = {"report"};

// The words of the message say what the option wants.
CLI::Validator finite_number(const std::string& name, const std::string& wanted,
                             const std::function<bool(double)>& fits) {
  return {[wanted, fits](std::string& text) {
            double value = 0;
            if (CLI::detail::lexical_cast(text, value) && std::isfinite(value) && fits(value))
              return std::string();
            return fmt::format("'{}' is not {}", text, wanted);
          },
          name};
}

// What goes with --relax, without it.
Status check_relaxing(const pipeline::RelaxSettings& relaxing, bool wants_cell) {
  const auto refused = [](std::string_view option) {
    return error(Kind::usage, fmt::format("{} says how yarns are moved apart: it goes with --relax", option));
  };
  if (relaxing.gap && relaxing.overlap)
    return error(Kind::usage, "--gap keeps yarns apart, --overlap lets them overlap: name one of the two");
  if (relaxing.wanted) return {};
  if (relaxing.gap && !wants_cell) return refused("--gap");
  if (relaxing.overlap) return refused("--overlap");
  if (relaxing.stiff_section) return refused("--stiff-section");
  if (relaxing.max_iterations > 0) return refused("--max-iterations");
  return {};
}

Status parse_shard(const std::string& text, pipeline::Options& options) {
  if (text.empty()) return {};
  const char* end = text.data() + text.size();
  const auto part = std::from_chars(text.data(), end, options.part);
  if (part.ec == std::errc() && part.ptr != end && *part.ptr == '/') {
    const auto parts = std::from_chars(part.ptr + 1, end, options.parts);
    if (parts.ec == std::errc() && parts.ptr == end && options.part < options.parts) return {};
  }
  return error(Kind::usage, fmt::format("--shard {}: it is I/N with 0 <= I < N, for example 0/4", text));
}

// Options that would do nothing are mistakes.
Status check_cell_options(const pipeline::Options& options) {
  if (options.matrix_size > 0 && !options.matrix)
    return error(Kind::usage, "--matrix-size is of the matrix: it goes with --matrix");
  if (options.bond && (!options.matrix || options.voxels > 0))
    return error(Kind::usage,
                 "--bond joins yarns in a mesh of tetrahedra with its matrix: it goes with --matrix, and "
                 "not with --voxel");
  if (!options.wants_cell() && (options.segments > 0 || options.chamis))
    return error(Kind::usage,
                 fmt::format("{} is of a unit cell: it goes with --matrix, --periodic, --cut or --voxel",
                             options.segments > 0 ? "--segments" : "--yarn-stiffness"));
  if (options.voxels > 0)
    for (const auto& [given, option] :
         {std::pair(options.size > 0, "--size"), std::pair(options.segments > 0, "--segments"),
          std::pair(options.matrix_size > 0, "--matrix-size"), std::pair(options.order == 2, "--order 2"),
          std::pair(options.min_dihedral > 0, "--min-dihedral")})
      if (given)
        return error(Kind::usage,
                     fmt::format("{} is of tetrahedra: it does not go with --voxel, which makes equal "
                                 "hexahedra of eight nodes",
                                 option));
  return {};
}

}  // namespace

CLI::Validator positive_number() {
  return finite_number("POSITIVE", "a positive number",
                       [](double value) { return value >= std::numeric_limits<double>::min(); });
}

CLI::Validator non_negative_number() {
  return finite_number("NONNEGATIVE", "zero or a positive number", [](double value) { return value >= 0; });
}

CLI::Validator number_between(double low, double high) {
  return finite_number(fmt::format("in [{} - {}]", low, high), fmt::format("from {} to {}", low, high),
                       [low, high](double value) { return value >= low && value <= high; });
}

Status complete(const Parsed& parsed, pipeline::Options& options) {
  if (Status status = parse_shard(parsed.shard, options); !status.ok()) return status;
  if (!parsed.units.empty()) options.units = unit_named(parsed.units);
  if (parsed.detail == "yarn") options.detail = fabric::Detail::yarn;
  if (parsed.detail == "plies") options.detail = fabric::Detail::plies;
  for (yarn::EndStyle style :
       {yarn::EndStyle::patch, yarn::EndStyle::fan, yarn::EndStyle::planar, yarn::EndStyle::none})
    if (parsed.ends == yarn::name_of(style)) options.ends = style;
  options.chamis = parsed.yarn_stiffness == "chamis";
  if (options.command == pipeline::Command::relax) options.relaxing.wanted = true;
  if (options.matrix) options.cut = true;
  if (options.cut && (options.instances || options.split_yarns))
    return error(Kind::usage, fmt::format("{} writes yarns whole: it does not go with {}",
                                          options.instances ? "--instances" : "--split-yarns",
                                          options.matrix ? "--matrix" : "--cut"));
  if (Status status = check_relaxing(options.relaxing, options.wants_cell()); !status.ok())
    return status.error();
  if (Status status = check_cell_options(options); !status.ok()) return status.error();
  if (options.resume && (options.report.empty() || options.report == "-"))
    return error(Kind::usage, "--resume goes by the report of the run before: name it with --report FILE");
  return {};
}

int tell(std::string_view text) {
  const Status printed = write_to_standard_output(text);
  if (printed) return 0;
  std::fprintf(stderr, "%s\n", to_string(printed.error()).c_str());
  return 1;
}

std::string later_command(const std::string& word) {
  if (std::find(later_commands.begin(), later_commands.end(), word) == later_commands.end()) return {};
  return fmt::format("'selvage {}' is not in this version of selvage", word);
}

void add_common(CLI::App& command, Parsed& parsed) {
  pipeline::Options& o = parsed.options;
  add_batch(command, parsed);
  command.add_option("--tolerance", o.tolerance, "of tubes, in the input's unit, instead of the input's own")
      ->check(positive_number());
}

void add_batch(CLI::App& command, Parsed& parsed) {
  pipeline::Options& o = parsed.options;
  command.add_option("INPUT", o.inputs, "files, folders, patterns, @LIST of paths, - for standard input")
      ->required();
  add_running(command, parsed, o);
  command.add_option("--report", o.report, "write a JSON report to this file");
  command.add_option("--shard", parsed.shard, "I/N: only the I-th of N equal parts of the inputs, from 0");
}

void add_running(CLI::App& command, Parsed& parsed, pipeline::Options& o) {
  command.add_option("-j", o.workers, "inputs worked on at once (default: one a core)")
      ->check(CLI::Range(1, 4096));
  command.add_flag("-q,--quiet", o.quiet, "errors only");
  command.add_flag("-v,--verbose", o.verbose, "say more");
  command.add_flag("--no-progress", o.no_progress, "no progress bar or lines");
  add_limits(command, o);
  command.add_flag("--strict", o.strict, "a warning fails its input");
  command
      .add_option("--detail", parsed.detail,
                  "yarn, plies or filaments: how far yarns are taken apart (default: as far as "
                  "their threads say)")
      ->check(CLI::IsMember({"yarn", "plies", "filaments"}));
  command.add_flag("--as-published", o.as_published,
                   "constructions exactly as their paper gives them, overlaps and all");
  add_outside(command, o.allow_outside);
}

void add_outside(CLI::App& command, bool& allow_outside) {
  command.add_flag("--allow-outside", allow_outside,
                   "files that a text names (`draft file`) may be anywhere, not only in its folder or below");
}

void add_limits(CLI::App& command, pipeline::Options& o) {
  command
      .add_option(
          "--timeout", o.timeout,
          fmt::format(
              "seconds an input may take (default: {:g} for formats of other programs, else no limit)",
              pipeline::foreign_timeout))
      ->check(positive_number());
  command
      .add_option(
          "--memory", o.memory,
          "MB of memory an input may take (default: what the machine, or the container, has free, shared by "
          "the inputs worked on at once; at least 1024)")
      ->check(positive_number());
  CLI::CheckedTransformer sandboxes(std::map<std::string, Sandbox>{
      {"require", Sandbox::required}, {"auto", Sandbox::automatic}, {"off", Sandbox::off}});
  sandboxes.description("{require,auto,off}");
  command
      .add_option("--sandbox", o.sandbox,
                  "keep the processes that read files to their inputs and outputs, without network: "
                  "require (or refuse to run), auto (the default: as far as the kernel can), off")
      ->transform(sandboxes);
}

void add_output(CLI::App& command, Parsed& parsed) {
  add_place(command, parsed);
  command.add_option("--to", parsed.options.formats,
                     "formats to write, separated by commas (see selvage formats)");
}

void add_place(CLI::App& command, Parsed& parsed) {
  command.add_option("-o,--output", parsed.options.output,
                     "a file (by its extension), a folder, or - for standard output");
  command.add_flag("--resume", parsed.options.resume,
                   "skip inputs that --report says are done, if their outputs are whole");
}

void add_ends(CLI::App& command, Parsed& parsed) {
  command
      .add_option("--ends", parsed.ends,
                  "how a yarn is sealed: patch, fan, planar, none (default: as the input has it, else patch)")
      ->check(CLI::IsMember({"patch", "fan", "planar", "none"}));
}

void add_units(CLI::App& command, Parsed& parsed, const std::string& help) {
  command.add_option("--units", parsed.units, help)->check(CLI::IsMember({"m", "cm", "mm", "um", "inch"}));
}

void run_pipeline(CLI::App& command, Parsed& parsed, pipeline::Command what) {
  command.callback([&parsed, what] {
    parsed.action = [&parsed, what] {
      parsed.options.command = what;
      if (Status status = complete(parsed, parsed.options); !status.ok())
        return pipeline::refuse(status.error());
      return pipeline::run(parsed.options);
    };
  });
}

}  // namespace selvage::cli
