// One input's work, in its own process: what it may use, and how it answers the parent.
#pragma once

#include <chrono>
#include <concepts>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "construction/build.h"
#include "core/diagnostics.h"
#include "core/process.h"
#include "core/source.h"
#include "core/tally.h"
#include "core/units.h"
#include "fabric/model.h"
#include "formats/format.h"
#include "garment/piece.h"
#include "pipeline/inputs.h"
#include "pipeline/options.h"
#include "pipeline/outputs.h"
#include "pipeline/report.h"
#include "pipeline/scaling.h"

namespace selvage::pipeline {

// Exit status of a job's process.
enum class Verdict { done = 0, failed = 1, defect = 3, skipped = 4 };

// Kinds of packets that a job sends to the parent.
namespace packet {
inline constexpr char message = 'm';   // a line or block for standard error
inline constexpr char result = 'r';    // a piece of standard output
inline constexpr char progress = 'p';  // what is being done right now
inline constexpr char report = 'j';    // the InputReport as text
inline constexpr char files = 'f';     // how many files were written, as decimal digits
inline constexpr char reader = 'd';  // the format that another program's library reads now, and of which file
inline constexpr char seconds = 's';     // that the job has from now on, as decimal digits
inline constexpr char separator = '\0';  // between the format and the file
}  // namespace packet

// What is to look at a CAD file while it is read; either may be empty.
struct CadLook {
  std::function<void(const Source&, const formats::Descriptor&)> file;  // before it is read
  std::function<void(const cad::Model&, const formats::Descriptor&)>
      model;  // before yarns are recognised in it
};

// What a function returns that said why it failed: false, or nothing.
struct Failed {
  template <std::same_as<bool> B>
  operator B() const {
    return false;
  }
  template <class T>
  operator std::optional<T>() const {
    return std::nullopt;
  }
};

class Job {
 public:
  Job(const Options& options, const Input& input, const std::vector<PlannedOutput>& outputs,
      const Channel& channel);

  const Options& options;
  const Input& input;
  const std::vector<PlannedOutput>& outputs;
  std::size_t threads = 1;      // that this job may use
  std::size_t number = 0;       // of the input in this run
  bool keeps_messages = false;  // in its report, whether or not that is written
  bool is_own = false;          // this job wrote its input itself
  bool says_once = false;       // warnings and notes that were said are not said again
  double seconds = 0;           // that it has, where options do not say so and its format is known
  double gap = 0;               // of constructions (fabric::BuildOptions::gap), file units
  bool unsolved = false;        // the yarns cannot be moved apart (it was said why): nothing is written
  InputReport report;

  // Passes a message on; one without a file gets the input's name. Of many alike the first are shown, and at
  // the end their number and the worst (core/tally.h has `badness`).
  void say(Message message, double badness = 0);
  // The same of what the caller fails by: `return job.fail(...)`.
  Failed fail(Message message) {
    say(std::move(message));
    return {};
  }
  // A defect that `check` found: shown like an error, but the input has not failed.
  void say_defect(Message message, double badness = 0);
  // What was not shown, of many alike. To be called when all is said.
  void say_rest();
  void say_all(const std::vector<Message>& messages);
  void print(std::string_view text) const { channel_.send(packet::result, text); }
  void tell_files(std::size_t count) const { channel_.send(packet::files, std::to_string(count)); }
  // "verb done of total", at most 20 times a second.
  void progress(std::string_view verb, std::size_t done, std::size_t total);
  // The same in other words.
  void progress(std::string_view what);
  // The same for whom it is called back: (done, total).
  [[nodiscard]] std::function<void(std::size_t, std::size_t)> progress_of(std::string_view verb) {
    return [this, verb](std::size_t done, std::size_t total) { progress(verb, done, total); };
  }

  [[nodiscard]] bool has_warned() const { return warnings_ > 0; }
  // An error, or with --strict a warning, was said.
  [[nodiscard]] bool has_failed() const { return errors_ > 0 || (options.strict && warnings_ > 0); }
  [[nodiscard]] bool wants_report() const { return options.wants_report(); }

  // Where no --timeout is given: ends this process at the limit for files of this format, from now on.
  void limit_time(const formats::Descriptor& format);
  // Reads the input; nothing when that failed (it was said why). The fabric of an input that cannot be built
  // is fine.
  std::optional<fabric::Fabric> read(const CadLook& look = {});
  // The builder of its yarns; nothing when that failed. It may have none where the fabric holds pieces.
  std::optional<fabric::YarnBuilder> builder(const fabric::Fabric& fabric);
  // Builds the yarns, a few at once on this job's threads, and hands them, or why there is none, to `take`
  // one by one in their order, in the file's unit; the next ones are built meanwhile. `verb` is for the
  // progress. Stops when `take` gives false.
  void build_each(const fabric::YarnBuilder& builder, std::string_view verb,
                  const std::function<bool(std::size_t index, Result<yarn::Body>&&)>& take);
  // The same, with their warnings said and their facts in the report. One that fails is told and left out;
  // the others are tried, so that every error is told.
  void for_each_yarn(const fabric::YarnBuilder& builder, std::string_view verb,
                     const std::function<bool(yarn::Body&&)>& take);
  // The same with yarns as they were swept: for who asks what they are, and not to have each at its place.
  void for_each_shape(const fabric::YarnBuilder& builder, std::string_view verb,
                      const std::function<void(const fabric::YarnBuilder::Shaped&)>& take);
  // All of them; nothing when one failed (the others were tried, so that every error is told).
  std::optional<std::vector<yarn::Body>> build_all(const fabric::YarnBuilder& builder);

  // One garment piece, in the file's unit, with its warnings said and its facts in the report; nothing when
  // it failed. `defects`: what is wrong with its outline is a defect, not a failure of the input.
  std::optional<fabric::PieceShape> build_piece(const fabric::Fabric& fabric, const fabric::Piece& piece,
                                                bool defects = false);

  [[nodiscard]] fabric::BuildOptions build_options() const;
  [[nodiscard]] const Channel& channel() const { return channel_; }
  [[nodiscard]] Unit file_units() const { return report.units.value_or(Unit::mm); }
  [[nodiscard]] Shown shown() const { return {file_units(), options.units.value_or(file_units())}; }

 private:
  void show(Message message, double badness);
  void tell(Message message);
  void forward(const Diagnostics& diagnostics);
  void take_files(fabric::Fabric& fabric, const Source& source, Diagnostics& diagnostics);

  const Channel& channel_;
  int errors_ = 0, warnings_ = 0;
  std::set<std::string> said_;  // with says_once
  Tally tally_;
  std::chrono::steady_clock::time_point last_progress_;
};

// Does the input's work and sends its report; never throws. `earlier`: the entry of this input in the report
// that
// `--resume` goes by, empty if there is none.
Verdict run_job(Job& job, const std::string& earlier, const Channel& channel);

// The subcommands, one file each (`relax` is a conversion). They say what went wrong; the caller looks at
// Job::has_failed().
void convert(Job& job);
void mesh(Job& job);
void info(Job& job);
void view(Job& job);
// True when a defect was found.
bool check(Job& job);
// True when something came back different.
bool roundtrip(Job& job);
// Of the input and its other one: `defect` when they differ.
Verdict diff(Job& job);
// One more `edit` line in a text, behind the block that makes the yarn and all edits that are there, when the
// yarn can be built with it.
void edit(Job& job);

}  // namespace selvage::pipeline
