#include "pipeline/diff.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <exception>
#include <new>

#include "core/process.h"
#include "core/progress.h"
#include "core/standard_output.h"
#include "pipeline/batch.h"
#include "pipeline/differences.h"
#include "pipeline/job.h"
#include "pipeline/parts.h"
#include "pipeline/subject.h"

namespace selvage::pipeline {

namespace {

constexpr std::size_t shown_differences = 20;
// Two roundings of each coordinate in a change of unit, in both files' worth of room.
constexpr double unit_rounding = 1e-15;

void print(const DiffRequest& request, const cad::Comparison& found, Unit units, const Channel& channel) {
  if (request.json) {
    channel.send(packet::result, to_json(found, request.a, request.b, request.tolerance, units));
    return;
  }
  std::string text;
  std::size_t shown = 0;
  for (const cad::Difference& difference : found.differences) {
    if (!request.all && shown == shown_differences) break;
    text += line_of(difference, units) + "\n";
    ++shown;
  }
  if (shown < found.differences.size())
    text += fmt::format("... and {} more (--all shows them)\n", found.differences.size() - shown);
  for (const std::string& note : found.notes) text += "note: " + note + "\n";
  channel.send(packet::result, text + summary_of(found, request.tolerance, units) + "\n");
}

// In a process of its own, as every reading of a file.
Verdict work(const DiffRequest& request, const Channel& channel) {
  std::array<cad::Subject, 2> subjects;
  const std::array<const std::string*, 2> paths = {&request.a, &request.b};
  bool has_failed = false;
  const std::vector<PlannedOutput> no_outputs;
  for (std::size_t k = 0; k < 2; ++k) {
    const Input input{first_file(*paths[k]).string(), {}};
    Job job(request.options, input, no_outputs, channel);
    job.threads = available_cores(request.options);
    const std::optional<fabric::Fabric> fabric = job.read();
    std::optional<cad::Subject> subject;
    if (fabric) subject = subject_of(job, *fabric);
    if (subject && !job.has_failed())
      subjects[k] = std::move(*subject);
    else
      has_failed = true;  // the other one is read all the same: its errors are told, too
  }
  if (has_failed) return Verdict::failed;
  auto& [a, b] = subjects;
  cad::CompareOptions options;
  options.tolerance = request.tolerance;
  options.threads = static_cast<int>(available_cores(request.options));
  const Unit units = a.model.units;
  std::string note;
  if (b.model.units != units) {
    note = fmt::format("units: {} and {}; compared in {}", name_of(units), name_of(b.model.units),
                       name_of(units));
    convert_lengths(b, units);
    options.rounding = unit_rounding;
  }
  const Input both{request.a, {}};
  Job job(request.options, both, no_outputs, channel);
  options.progress = [&](std::size_t done, std::size_t total) { job.progress("comparing", done, total); };
  cad::Comparison found = cad::compare(a, b, options);
  if (!note.empty()) found.notes.insert(found.notes.begin(), note);
  print(request, found, units, channel);
  return found.differences.empty() ? Verdict::done : Verdict::defect;
}

Verdict guarded_work(const DiffRequest& request, const Channel& channel) {
  const auto fail = [&](Message message) {
    message.file = "selvage";
    channel.send(packet::message, to_string(message));
    return Verdict::failed;
  };
  try {
    return work(request, channel);
  } catch (const std::bad_alloc&) {
    return fail(error(Kind::limit, "the comparison needs more memory than there is"));
  } catch (const std::exception& failure) {
    return fail(error(Kind::internal, fmt::format("unexpected failure: {}", failure.what())));
  }
}

}  // namespace

int diff(const DiffRequest& request) {
  ProgressDisplay progress(!request.options.quiet && !request.options.no_progress, 1);
  std::string results;
  int code = 1;
  JobPool pool;
  pool.count = 1;
  pool.seconds = request.options.timeout;
  pool.mebibytes = request.options.memory;
  pool.run = [&](std::size_t, const Channel& channel) {
    return static_cast<int>(guarded_work(request, channel));
  };
  pool.received = [&](std::size_t, char kind, std::string_view bytes) {
    if (kind == packet::result) results += bytes;
    if (kind == packet::progress) progress.set(0, 0, std::string(bytes));
    if (kind != packet::message) return;
    progress.clear();
    std::fprintf(stderr, "%.*s\n", static_cast<int>(bytes.size()), bytes.data());
  };
  pool.finished = [&](std::size_t, const JobEnd& end) {
    progress.clear();
    code = end.how == JobEnd::How::exited ? end.status : 1;
    if (const std::string reason = describe(end, request.options.timeout, request.options.memory);
        !reason.empty())
      std::fprintf(stderr, "selvage: error: the comparison %s\n", reason.c_str());
  };
  pool.tick = [&] { return progress.tick(); };
  if (!run_jobs(pool)) {
    std::fputs("selvage: interrupted\n", stderr);
    return 130;
  }
  if (Status printed = write_to_standard_output(results); !printed) {
    std::fprintf(stderr, "%s\n", to_string(printed.error()).c_str());
    return 1;
  }
  return code;
}

}  // namespace selvage::pipeline
