#include "pipeline/batch.h"

#include <fmt/format.h>
#include <malloc.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <new>

#include "core/clock.h"
#include "core/console.h"
#include "core/memory_files.h"
#include "core/process.h"
#include "core/progress.h"
#include "core/readable.h"
#include "core/shared_text.h"
#include "core/standard_output.h"
#include "core/temporary.h"
#include "core/words.h"
#include "pipeline/edit.h"
#include "pipeline/inputs.h"
#include "pipeline/job.h"
#include "pipeline/junit.h"
#include "pipeline/limits.h"
#include "pipeline/outputs.h"
#include "pipeline/report.h"
#include "pipeline/report_command.h"
#include "pipeline/report_reader.h"
#include "pipeline/roundtrip.h"
#include "pipeline/sweep_table.h"

namespace selvage::pipeline {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

namespace exit_code {
constexpr int well = 0, failed = 1, usage = 2, defect = 3, interrupted = 130;
}

// A run that is killed shall leave a report to resume from, but writing it shall not cost more than this
// share of the time.
constexpr double report_interval = 10;  // seconds
constexpr double report_share = 0.05;

// Bytes of an input's messages. Workers say few (core/tally.h); what is wrong with one shall not eat memory
// here.
constexpr std::size_t most_kept = 1U << 20;
// And of its results and its report, which are whole or not there.
constexpr std::size_t most_results = most_packet_bytes;

class Batch {
 public:
  Batch(const Options& options, const Plan& plan, std::map<std::string, std::string> earlier)
      : options_(options),
        plan_(plan),
        earlier_(std::move(earlier)),
        reports_(options.wants_report() ? plan.size() : 0),
        progress_(options.progress_json                    ? ProgressForm::json
                  : !options.quiet && !options.no_progress ? ProgressForm::shown
                                                           : ProgressForm::none,
                  plan.size()) {}

  int run(const std::vector<Message>& missing);

 private:
  // What came from one input so far.
  struct Work {
    std::string messages, results;
    std::size_t left_out = 0;  // messages beyond what is kept
    std::size_t kept = 0;      // bytes of results and reports
    bool overflows = false;    // there were more than are kept
    bool ended = false;
    bool is_unusable = false;  // what it reports
    double seconds = 0;        // that it has, where no option says so
    std::string reader, read;  // the format whose library reads a file now, and the file; empty: none
  };

  int run_one(std::size_t job, const Channel& channel) const;
  Verdict run_contained(std::size_t job, const Channel& channel) const;
  void receive(std::size_t job, char kind, std::string_view bytes);
  void finish(std::size_t job, const JobEnd& end);
  void fail(std::size_t job, Message message);
  void keep_report(std::size_t job, std::string_view text);
  void flush_results();
  void show(std::string& text);
  double tick();
  void remove_leftovers() const;

  [[nodiscard]] std::string report_text(bool ok) const;
  Status write_report(bool ok) const;
  Status write_junit(const std::vector<Message>& missing) const;
  Status write_table() const;
  [[nodiscard]] std::string entry_of_earlier(const std::string& path) const;
  [[nodiscard]] int exit_code() const;
  void summarize() const;

  const Options& options_;
  const Plan& plan_;
  std::map<std::string, std::string> earlier_;  // entries of the report that --resume goes by
  std::map<std::size_t, Work> work_;            // of inputs that began, until their results are printed
  SharedText report_texts_;
  std::vector<std::string_view> reports_;  // of each input, where they are wanted
  std::vector<std::string> missing_reports_;
  ProgressDisplay progress_;
  std::string doing_;
  Counts counts_;
  std::size_t defects_ = 0, files_ = 0;
  std::size_t next_result_ = 0;
  bool has_lost_workers_ = false;  // that were killed, or crashed
  Status printed_;                 // of standard output: what could not be written
  std::string started_ = options_.wants_report() ? iso_timestamp() : std::string();
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_report_ = start_ + std::chrono::seconds(static_cast<int>(report_interval));
};

// Exit status of a job that had too little memory to begin with, when it could not report anything itself.
constexpr int out_of_memory_status = 118;

bool is_verdict(int status) {
  for (Verdict verdict : {Verdict::done, Verdict::failed, Verdict::defect, Verdict::skipped})
    if (status == static_cast<int>(verdict)) return true;
  return false;
}

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Status write_whole(const std::string& place, const std::string& text) {
  Result<OutputFile> file = place == "-" ? OutputFile::standard_output() : OutputFile::create(place);
  if (!file) return file.error();
  if (Status status = file->write(text); !status.ok()) return status;
  return file->commit();
}

UsedStreams streams_of(const PlannedInput& planned) {
  return {.input = planned.input.path == "-" || planned.input.other == "-",
          .output = std::ranges::any_of(planned.outputs, &PlannedOutput::to_standard_output)};
}

int Batch::run_one(std::size_t index, const Channel& channel) const {
  try {
    return static_cast<int>(run_contained(index, channel));
  } catch (const std::bad_alloc&) {  // anything else is a crash, and reported as one
    return out_of_memory_status;
  }
}

Verdict Batch::run_contained(std::size_t index, const Channel& channel) const {
  const PlannedInput planned = plan_.at(index);
  const Input& input = planned.input;
  Job job(options_, input, planned.outputs, channel);
  job.number = index;
  const std::size_t workers = available_cores(options_);
  job.threads = std::max<std::size_t>(1, workers / std::min(workers, plan_.size()));
  std::vector<fs::path> places;
  for (const PlannedOutput& output : planned.outputs)
    if (!output.to_standard_output) std::ranges::move(places_of(output), std::back_inserter(places));
  // Where a contained process's output to standard output waits until it is whole. glTF has the most files.
  constexpr std::size_t most_files = 12;
  if (streams_of(planned).output) reserve_memory_files(most_files);
  if (const Status contained = contain_job(options_, std::array{input.path, input.other}, places);
      !contained) {
    job.say(contained.error());
    InputReport report(input);
    report.messages.push_back(contained.error());
    if (options_.wants_report()) channel.send(packet::report, report.text());
    return Verdict::failed;
  }
  return run_job(job, entry_of_earlier(input.name()), channel);
}

std::string Batch::entry_of_earlier(const std::string& path) const {
  const auto found = earlier_.find(path);
  return found == earlier_.end() ? std::string() : found->second;
}

void Batch::receive(std::size_t job, char kind, std::string_view bytes) {
  Work& work = work_[job];
  if (kind == packet::result || kind == packet::report) {
    work.kept += bytes.size();
    work.overflows = work.overflows || work.kept > most_results;
    if (work.overflows) return;
  }
  if (kind == packet::message) {
    if (work.messages.size() > most_kept) {
      ++work.left_out;
    } else {
      work.messages += bytes;
      work.messages += '\n';
    }
  } else if (kind == packet::result) {
    if (!options_.sweep.wanted && options_.csv != "-") work.results += bytes;  // the table has them
  } else if (kind == packet::report) {
    keep_report(job, bytes);
  } else if (kind == packet::files) {
    std::size_t count = 0;
    std::from_chars(bytes.data(), bytes.data() + bytes.size(), count);
    files_ += count;
  } else if (kind == packet::reader) {
    const std::size_t mark = std::min(bytes.find(packet::separator), bytes.size());
    work.reader = bytes.substr(0, mark);
    work.read = bytes.substr(std::min(mark + 1, bytes.size()));
  } else if (kind == packet::seconds) {
    std::from_chars(bytes.data(), bytes.data() + bytes.size(), work.seconds);
  } else if (kind == packet::progress) {
    doing_ = bytes;
    progress_.set(counts_.done + counts_.failed + counts_.skipped, counts_.failed, doing_);
  }
}

void Batch::show(std::string& text) {
  if (text.empty()) return;
  progress_.clear();
  write_messages(text);
  text.clear();
}

void Batch::flush_results() {
  for (auto next = work_.find(next_result_); next != work_.end() && next->second.ended;
       next = work_.find(++next_result_)) {
    const std::string& results = next->second.results;
    if (!results.empty()) {
      progress_.clear();
      if (printed_) printed_ = write_to_standard_output(results);
    }
    work_.erase(next);
  }
}

// What a process says that has read a stranger's file is read as one reads strangers' reports.
void Batch::keep_report(std::size_t job, std::string_view text) {
  if (reports_.empty()) return;
  if (const Result<Json> entry = parse_entry(text); entry) {
    reports_[job] = report_texts_.keep(text);
  } else {
    work_[job].is_unusable = true;
    fail(job, error(Kind::internal, fmt::format("what it reports cannot be used: {}", entry.error().text)));
  }
}

void Batch::fail(std::size_t job, Message message) {
  const std::string path = message.file.empty() ? std::string(plan_.inputs().path(job)) : message.file;
  message.file = path == "-" ? "<stdin>" : path;
  work_[job].messages += to_string(message) + "\n";
  if (!options_.wants_report()) return;
  InputReport report(plan_.inputs().at(job));
  report.messages.push_back(std::move(message));
  reports_[job] = report_texts_.keep(report.text());
}

// The signals of a library that goes astray, not of somebody who ends a process.
bool is_crash(int signal) {
  return signal == SIGSEGV || signal == SIGBUS || signal == SIGABRT || signal == SIGFPE || signal == SIGILL;
}

void Batch::finish(std::size_t job, const JobEnd& end) {
  Work& work = work_[job];
  work.ended = true;
  std::string reason =
      describe(end, options_.timeout > 0 ? options_.timeout : work.seconds, memory_limit(options_));
  const bool is_out_of_memory = reason.empty() && end.status == out_of_memory_status;
  if (is_out_of_memory) reason = fmt::format("needs more memory than {}", memory_limit(options_));
  if (reason.empty() && !is_verdict(end.status)) {
    // A library that ends the process by itself, as the C library does when thread storage cannot be had.
    reason = fmt::format("ended unexpectedly, with status {} (it could not take more memory than {})",
                         end.status, memory_limit(options_));
  }
  if (reason.empty() && work.overflows) reason = describe({JobEnd::How::unheard, EMSGSIZE}, 0, {});
  if (!reason.empty()) {
    const Input input = plan_.inputs().at(job);
    const bool is_killed = end.how == JobEnd::How::signalled && is_crash(end.status);
    // Of the files that a job reads, those of the user; what it has written itself is no fault of theirs.
    if (is_killed && !work.reader.empty() && (work.read == input.path || work.read == input.other))
      fail(job,
           error(Kind::malformed,
                 fmt::format(
                     "what this file says makes the reader of {} fail ({}): it is damaged, or breaks its "
                     "format in a way that is not told apart; write it anew where it comes from",
                     work.reader, ::strsignal(end.status)),
                 {.file = work.read}));
    else
      fail(job, error(end.how == JobEnd::How::timed_out || end.how == JobEnd::How::used_up || is_out_of_memory
                          ? Kind::limit
                          : Kind::internal,
                      (input.other.empty() ? "this input " : "the comparison ") + reason));
    has_lost_workers_ = true;
  }
  const auto verdict =
      reason.empty() && !work.is_unusable ? static_cast<Verdict>(end.status) : Verdict::failed;
  if (verdict == Verdict::skipped) {
    ++counts_.skipped;
  } else if (verdict == Verdict::done || verdict == Verdict::defect) {
    ++counts_.done;
    if (verdict == Verdict::defect) ++defects_;
  } else {
    ++counts_.failed;
  }
  if (work.left_out > 0)
    work.messages +=
        fmt::format("{}: and {} further messages\n", readable(plan_.inputs().path(job)), work.left_out);
  show(work.messages);
  flush_results();
  progress_.set(counts_.done + counts_.failed + counts_.skipped, counts_.failed, doing_);
}

// Hidden files of workers that were killed, in this run or an earlier one.
void Batch::remove_leftovers() const {
  std::set<fs::path> folders;
  const auto add = [&](const fs::path& target) {
    if (std::optional<fs::path> folder = OutputFile::hidden_folder(target))
      folders.insert(std::move(*folder));
  };
  for (const std::string* place : {&options_.report, &options_.junit, &options_.csv})
    if (!place->empty() && *place != "-") add(*place);
  for (std::size_t i = 0; i < plan_.size(); ++i)
    for (const PlannedOutput& output : plan_.at(i).outputs)
      if (!output.to_standard_output) std::ranges::for_each(places_of(output), add);
  OutputFile::remove_leftovers(folders);
}

double Batch::tick() {
  const double seconds = progress_.tick();
  if (options_.report.empty() || options_.report == "-") return seconds;
  if (Clock::now() >= next_report_) {
    const Clock::time_point begin = Clock::now();
    // A report that cannot be written is told at the end; until then the work goes on.
    (void)write_report(false).ok();
    const double pause = std::max(report_interval, seconds_since(begin) / report_share);
    next_report_ =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(pause));
  }
  return std::min(seconds, std::chrono::duration<double>(next_report_ - Clock::now()).count());
}

std::string Batch::report_text(bool ok) const {
  std::vector<std::string> entries;
  for (std::size_t i = 0; i < reports_.size(); ++i) {
    // An input that was not reached keeps what an earlier run knew of it.
    entries.push_back(reports_[i].empty() ? entry_of_earlier(plan_.inputs().at(i).name())
                                          : std::string(reports_[i]));
  }
  entries.insert(entries.end(), missing_reports_.begin(), missing_reports_.end());
  return whole_report(started_, seconds_since(start_), ok, counts_, entries);
}

Status Batch::write_report(bool ok) const {
  if (options_.report.empty()) return {};
  return write_whole(options_.report, report_text(ok));
}

// A row for each input, or variant of a sweep.
Status Batch::write_table() const {
  if (options_.csv.empty()) return {};
  SweepTable table(options_.sweep.wanted ? "variant" : "input");
  for (std::size_t i = 0; i < plan_.size(); ++i) {
    const Input input = plan_.inputs().at(i);
    table.add(input, reports_[i].empty() ? entry_of_earlier(input.name()) : std::string(reports_[i]));
  }
  return write_whole(options_.csv, table.text());
}

Status Batch::write_junit(const std::vector<Message>& missing) const {
  if (options_.junit.empty()) return {};
  const std::string_view word = options_.command == Command::diff    ? "diff"
                                : options_.command == Command::check ? "check"
                                                                     : "roundtrip";
  std::vector<JunitInput> all;
  for (std::size_t i = 0; i < reports_.size(); ++i)
    all.push_back({plan_.inputs().at(i).name(), std::string(reports_[i])});
  for (std::size_t i = 0; i < missing.size(); ++i) all.push_back({missing[i].file, missing_reports_[i]});
  return write_whole(options_.junit, junit_text(word, all, started_, seconds_since(start_)));
}

int Batch::exit_code() const {
  if (counts_.failed > 0) return exit_code::failed;
  return defects_ > 0 ? exit_code::defect : exit_code::well;
}

void Batch::summarize() const {
  if (options_.sweep.wanted && !options_.quiet && options_.csv != "-") {
    std::string text = fmt::format("selvage: {}: {} ok", counted(counts_.inputs, "variant"),
                                   counts_.done + counts_.skipped - std::min(defects_, counts_.done));
    if (defects_ > 0) text += fmt::format(", {} with defects", defects_);
    if (counts_.failed > 0) text += fmt::format(", {} failed", counts_.failed);
    text += fmt::format("; parameters and results are in '{}'\n", readable(options_.csv));
    std::fwrite(text.data(), 1, text.size(), stderr);
  }
  const bool writes = options_.command == Command::convert || options_.command == Command::relax ||
                      options_.command == Command::mesh || options_.command == Command::view;
  if (options_.quiet || !writes || options_.output == "-") return;
  std::string text = fmt::format("selvage: {} of {} inputs done", counts_.done, counts_.inputs);
  if (counts_.skipped > 0) text += fmt::format(", {} were up to date", counts_.skipped);
  if (counts_.failed > 0) text += fmt::format(", {} failed", counts_.failed);
  text += fmt::format("; {} written", counted(files_, "file"));
  if (!options_.output.empty()) text += fmt::format(" to '{}'", readable(options_.output));
  text += '\n';
  std::fwrite(text.data(), 1, text.size(), stderr);
}

int Batch::run(const std::vector<Message>& missing) {
  counts_.inputs = plan_.size() + missing.size();
  for (const Message& message : missing) {
    std::string text = to_string(message) + "\n";
    show(text);
    ++counts_.failed;
    InputReport report({message.file, {}});
    report.messages.push_back(message);
    if (options_.wants_report()) missing_reports_.push_back(report.text());
  }
  remove_leftovers();

  NewFolders folders;
  for (std::size_t i = 0; i < plan_.size(); ++i)
    for (const PlannedOutput& output : plan_.at(i).outputs)
      if (!output.to_standard_output)
        for (const fs::path& place : places_of(output)) folders.expect(place);
  // Each input's process begins as a copy of this one: what the plan took and gave back would be copied, too.
  ::malloc_trim(0);
  JobPool pool;
  pool.count = plan_.size();
  pool.at_once = available_cores(options_);
  pool.seconds = options_.timeout;
  pool.mebibytes = options_.memory;
  pool.streams = [this](std::size_t job) { return streams_of(plan_.at(job)); };
  pool.run = [this](std::size_t job, const Channel& channel) { return run_one(job, channel); };
  pool.received = [this](std::size_t job, char kind, std::string_view bytes) { receive(job, kind, bytes); };
  pool.finished = [this](std::size_t job, const JobEnd& end) { finish(job, end); };
  pool.interrupted = [this](std::size_t) { has_lost_workers_ = true; };
  pool.tick = [this] { return tick(); };
  const Result<PoolEnd> end = run_jobs(pool);
  progress_.finish();
  if (has_lost_workers_) remove_leftovers();

  const bool complete = end.ok() && *end == PoolEnd::complete;
  int code = complete ? exit_code() : end.ok() ? exit_code::interrupted : exit_code::failed;
  if (!end.ok()) (void)refuse(end.error());
  if (end.ok() && !complete)
    std::fputs(options_.command == Command::diff
                   ? "selvage: interrupted\n"
                   : "selvage: interrupted; the inputs that were not done have no new outputs\n",
               stderr);
  if (options_.json && options_.command == Command::info && printed_)
    printed_ = write_to_standard_output(report_text(code == exit_code::well));
  for (const Status& status :
       {printed_, write_report(code == exit_code::well), write_junit(missing), write_table()}) {
    if (status.ok()) continue;
    write_messages(to_string(status.error()) + "\n");
    if (complete) code = exit_code::failed;
  }
  if (complete) summarize();
  return code;
}

Result<std::map<std::string, std::string>> earlier_entries(const Options& options) {
  if (!options.resume) return std::map<std::string, std::string>{};
  std::error_code failure;
  if (!std::filesystem::exists(options.report, failure)) return std::map<std::string, std::string>{};
  return read_entries(options.report);
}

// A report that cannot be written is better known before the work than after it.
Status check_report_places(const Options& options) {
  for (const std::string* place : {&options.report, &options.junit, &options.csv}) {
    if (place->empty() || *place == "-") continue;
    if (const Result<OutputFile> trial = OutputFile::create(*place); !trial) return trial.error();
  }
  return {};
}

}  // namespace

std::size_t available_cores(const Options& options) {
  if (options.workers > 0) return options.workers;
  cpu_set_t set;
  if (::sched_getaffinity(0, sizeof set, &set) != 0) return 1;
  return static_cast<std::size_t>(std::max(1, CPU_COUNT(&set)));
}

int refuse(const Message& message) {
  Message shown = message;
  if (shown.file.empty()) shown.file = "selvage";
  write_messages(to_string(shown) + "\n");
  return exit_code::usage;
}

namespace {

int run_all(Options options) {
  if (const Status clock = check_clock(); !clock) return refuse(clock.error());
  if (options.command == Command::report) return run_report(options);
  if (Status status = check_sandbox(options.sandbox, this_kernel()); !status) return refuse(status.error());
  std::optional<TemporaryFolder> scratch;
  if (options.command == Command::roundtrip) {
    if (const Result<std::vector<Trip>> trips = wanted_trips(options); !trips) return refuse(trips.error());
    Result<TemporaryFolder> made = TemporaryFolder::create();
    if (!made) {
      (void)refuse(made.error());
      return exit_code::failed;  // the command line is well
    }
    options.scratch = scratch.emplace(std::move(*made)).path();
  }
  if (options.command == Command::edit)
    if (const Result<formats::NewEdit> edit = wanted_edit(options.edit); !edit) return refuse(edit.error());
  Result<InputList> list = inputs_of(options);
  if (!list) return refuse(list.error());
  Result<Plan> plan = Plan::make(options, *list);
  if (!plan) return refuse(plan.error());
  Result<std::map<std::string, std::string>> earlier = earlier_entries(options);
  if (!earlier) return refuse(earlier.error());
  if (Status status = check_report_places(options); !status.ok()) return refuse(status.error());
  share_memory(options, std::min(available_cores(options), plan->size()));
  plan->keep_part(options.part, options.parts);
  if (options.part > 0) {
    list->missing.clear();
    list->notes.clear();
  }
  if (!options.quiet)
    for (const Message& note : list->notes) write_messages(to_string(note) + "\n");
  return Batch(options, *plan, std::move(*earlier)).run(list->missing);
}

}  // namespace

int run(const Options& options) {
  int code = exit_code::failed;
  if (const Status done = guarded(options, [&] { code = run_all(options); }); !done)
    (void)refuse(done.error());
  return code;
}

}  // namespace selvage::pipeline
