// `selvage diff`: the geometry of two files of any readable formats.
#include <fmt/format.h>

#include <map>

#include "core/words.h"
#include "pipeline/differences.h"
#include "pipeline/report.h"
#include "pipeline/subject.h"

namespace selvage::pipeline {

namespace {

constexpr std::size_t shown_differences = 20;
// Two roundings of each coordinate in a change of unit, in both files' worth of room.
constexpr double unit_rounding = 1e-15;

void print(const Job& job, const cad::Comparison& found, Unit units) {
  const Options& asked = job.options;
  if (asked.json)
    return job.print(to_json(found, asked.inputs[0], asked.inputs[1], asked.difference_tolerance, units));
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
  job.print(text + summary_of(found, asked.difference_tolerance, units) + "\n");
}

// A test case for each thing of either file, with what is different about it.
void report(Job& job, const cad::Comparison& found, Unit units) {
  std::map<std::pair<std::string, std::string>, std::vector<std::string>> by_thing;
  for (const cad::Difference& difference : found.differences)
    by_thing[{std::string(name_of(difference.what)), difference.name}].push_back(line_of(difference, units));
  Json& all = job.report["compared"] = Json::array();
  const auto add = [&](std::string_view what, const std::string& name,
                       const std::vector<std::string>& lines) {
    all.push_back({{"name", fmt::format("{} {}", what, name.empty() ? "without a name" : in_quotes(name))},
                   {"differences", lines}});
  };
  for (const cad::Comparison::Match& match : found.matches) {
    const auto lines = by_thing.find({std::string(name_of(match.what)), match.name});
    add(name_of(match.what), match.name,
        lines == by_thing.end() ? std::vector<std::string>{} : std::move(lines->second));
    if (lines != by_thing.end()) by_thing.erase(lines);
  }
  for (const auto& [thing, lines] : by_thing) add(thing.first, thing.second, lines);
}

// By a job of its own, whose messages name the file. Nothing when it failed.
std::optional<cad::Subject> read(const Job& job, const std::string& path) {
  const Input input{path, {}};
  Job own(job.options, input, job.outputs, job.channel());
  own.threads = job.threads;
  const std::optional<fabric::Fabric> fabric = own.read();
  std::optional<cad::Subject> subject;
  if (fabric) subject = subject_of(own, *fabric);
  own.say_rest();
  return own.has_failed() ? std::nullopt : std::move(subject);
}

}  // namespace

Verdict diff(Job& job) {
  // Where the first fails, the other one is read all the same: its errors are told, too.
  std::optional<cad::Subject> a = read(job, job.input.path), b = read(job, job.input.other);
  if (!a || !b) return Verdict::failed;
  cad::CompareOptions options;
  options.tolerance = job.options.difference_tolerance;
  options.threads = static_cast<int>(job.threads);
  options.progress = job.progress_of("comparing");
  const Unit units = a->model.units;
  std::string note;
  if (b->model.units != units) {
    note = fmt::format("units: {} and {}; compared in {}", name_of(units), name_of(b->model.units),
                       name_of(units));
    convert_lengths(*b, units);
    options.rounding = unit_rounding;
  }
  cad::Comparison found = cad::compare(*a, *b, options);
  if (!note.empty()) found.notes.insert(found.notes.begin(), note);
  print(job, found, units);
  if (!job.options.junit.empty()) report(job, found, units);
  return found.differences.empty() ? Verdict::done : Verdict::defect;
}

}  // namespace selvage::pipeline
