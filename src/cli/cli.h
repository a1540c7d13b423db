// The command line: one file a subcommand, each of which adds itself to the parser.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "pipeline/diff.h"
#include "pipeline/edit.h"
#include "pipeline/options.h"

namespace selvage::cli {

// Where the parsed values go: `action` is what the chosen subcommand does; its value is the exit code.
struct Parsed {
  pipeline::Options options;
  std::string shard, units, ends, detail = "filaments", yarn_stiffness = "given";
  pipeline::EditRequest edit;
  pipeline::DiffRequest diff;
  std::function<int()> action;
};

void add_convert(CLI::App& program, Parsed& parsed);
void add_check(CLI::App& program, Parsed& parsed);
void add_relax(CLI::App& program, Parsed& parsed);
void add_mesh(CLI::App& program, Parsed& parsed);
void add_info(CLI::App& program, Parsed& parsed);
void add_diff(CLI::App& program, Parsed& parsed);
void add_roundtrip(CLI::App& program, Parsed& parsed);
void add_edit(CLI::App& program, Parsed& parsed);
void add_view(CLI::App& program, Parsed& parsed);
void add_formats(CLI::App& program, Parsed& parsed);

// What a number has to be, for ->check(): finite, and in range. CLI11's own let nan pass.
CLI::Validator positive_number();
CLI::Validator non_negative_number();
CLI::Validator number_between(double low, double high);

// Options that several subcommands have (common.cpp).
void add_common(CLI::App& command, Parsed& parsed);
// Of these, the inputs and what every batch has, without --tolerance.
void add_batch(CLI::App& command, Parsed& parsed);
// Of these, what a single job has: -j, --quiet, --timeout, ...
void add_running(CLI::App& command, Parsed& parsed, pipeline::Options& options);
void add_outside(CLI::App& command, bool& allow_outside);
void add_output(CLI::App& command, Parsed& parsed);
// Of these, what bounds a job: --timeout, --memory, --sandbox.
void add_limits(CLI::App& command, pipeline::Options& options);
// -o and --resume, without --to.
void add_place(CLI::App& command, Parsed& parsed);
void add_ends(CLI::App& command, Parsed& parsed);
void add_units(CLI::App& command, Parsed& parsed, const std::string& help);
// Of surfaces in files: IGES and STEP.
void add_surfaces(CLI::App& command, Parsed& parsed);
// --relax (but not for `selvage relax` itself) and what goes with it.
void add_relaxing(CLI::App& command, Parsed& parsed, bool with_flag);
// Takes over what was parsed as words. Errors (usage): a shard that is none, --resume without a report,
// options that go with --relax without it.
Status complete(const Parsed& parsed, pipeline::Options& options);
// Runs the pipeline with the parsed options when the subcommand was named.
void run_pipeline(CLI::App& command, Parsed& parsed, pipeline::Command what);

// Prints what was asked for: the exit code, 1 (with a message) where standard output cannot be written.
int tell(std::string_view text);

// Words of the contract that come with later versions: "" when `word` is none, else what to tell.
std::string later_command(const std::string& word);

}  // namespace selvage::cli
