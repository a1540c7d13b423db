#include "pipeline/diff.h"

#include <fmt/format.h>

#include <array>

#include "pipeline/batch.h"
#include "pipeline/differences.h"
#include "pipeline/job.h"
#include "pipeline/parts.h"
#include "pipeline/single.h"
#include "pipeline/subject.h"

namespace selvage::pipeline {

namespace {

constexpr std::size_t shown_differences = 20;
// Two roundings of each coordinate in a change of unit, in both files' worth of room.
constexpr double unit_rounding = 1e-15;

void print(const Options& asked, const cad::Comparison& found, Unit units, const Channel& channel) {
  if (asked.json) {
    channel.send(packet::result,
                 to_json(found, asked.inputs[0], asked.inputs[1], asked.difference_tolerance, units));
    return;
  }
  std::string text;
  std::size_t shown = 0;
  for (const cad::Difference& difference : found.differences) {
    if (!asked.all && shown == shown_differences) break;
    text += line_of(difference, units) + "\n";
    ++shown;
  }
  if (shown < found.differences.size())
    text += fmt::format("... and {} more (--all shows them)\n", found.differences.size() - shown);
  for (const std::string& note : found.notes) text += "note: " + note + "\n";
  channel.send(packet::result, text + summary_of(found, asked.difference_tolerance, units) + "\n");
}

// In a process of its own, as every reading of a file.
Verdict work(const Options& asked, const Channel& channel) {
  std::array<cad::Subject, 2> subjects;
  bool has_failed = false;
  const std::vector<PlannedOutput> no_outputs;
  for (std::size_t k = 0; k < 2; ++k) {
    const Input input{first_file(asked.inputs[k]).string(), {}};
    Job job(asked, input, no_outputs, channel);
    job.threads = available_cores(asked);
    const std::optional<fabric::Fabric> fabric = job.read();
    std::optional<cad::Subject> subject;
    if (fabric) subject = subject_of(job, *fabric);
    job.say_rest();
    if (subject && !job.has_failed())
      subjects[k] = std::move(*subject);
    else
      has_failed = true;  // the other one is read all the same: its errors are told, too
  }
  if (has_failed) return Verdict::failed;
  auto& [a, b] = subjects;
  cad::CompareOptions options;
  options.tolerance = asked.difference_tolerance;
  options.threads = static_cast<int>(available_cores(asked));
  const Unit units = a.model.units;
  std::string note;
  if (b.model.units != units) {
    note = fmt::format("units: {} and {}; compared in {}", name_of(units), name_of(b.model.units),
                       name_of(units));
    convert_lengths(b, units);
    options.rounding = unit_rounding;
  }
  const Input both{asked.inputs[0], {}};
  Job job(asked, both, no_outputs, channel);
  options.progress = [&](std::size_t done, std::size_t total) { job.progress("comparing", done, total); };
  cad::Comparison found = cad::compare(a, b, options);
  if (!note.empty()) found.notes.insert(found.notes.begin(), note);
  print(asked, found, units, channel);
  return found.differences.empty() ? Verdict::done : Verdict::defect;
}

}  // namespace

int diff(const Options& options) {
  const std::string &a = options.inputs[0], &b = options.inputs[1];
  if (a == "-" && b == "-") return refuse(error(Kind::usage, "standard input can be only one of the two"));
  return run_single(options, {.what = "the comparison",
                              .inputs = {first_file(a).string(), first_file(b).string()},
                              .outputs = {},
                              .work = [&](const Channel& channel) { return work(options, channel); }});
}

}  // namespace selvage::pipeline
