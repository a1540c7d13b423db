#include "pipeline/job.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <utility>

#include "construction/settle_cell.h"
#include "core/number_text.h"
#include "core/parallel.h"
#include "core/sha256.h"
#include "core/source.h"
#include "core/words.h"
#include "fabric/from_cad.h"
#include "fabric/loft.h"
#include "pipeline/detect.h"
#include "pipeline/facts.h"
#include "pipeline/limits.h"
#include "pipeline/named_files.h"
#include "pipeline/parts.h"
#include "pipeline/unit_cell.h"
#include "pipeline/versions.h"

namespace selvage::pipeline {

namespace {

using Clock = std::chrono::steady_clock;
constexpr auto progress_interval = std::chrono::milliseconds(50);

// Everything beside the input that changes the bytes of an output: the program, its libraries, the command
// line.
std::string settings_of(const Options& options) {
  std::string text = fmt::format("selvage={} build={}", version(), build_identity());
  for (const Library& library : library_versions())
    text += fmt::format(" {}={}", library.name, library.version);
  text += fmt::format(" {}{}", name_of(options.command), options.settings);
  return text;
}

// Of a fabric in several files: all but the first.
std::vector<std::filesystem::path> further_files(const std::string& path) {
  std::vector<std::filesystem::path> files = files_of(path);
  files.erase(files.begin());
  return files;
}

}  // namespace

Job::Job(const Options& options_in, const Input& input_in, const std::vector<PlannedOutput>& outputs_in,
         const Channel& channel)
    : options(options_in), input(input_in), outputs(outputs_in), report(input), channel_(channel) {}

void Job::say(Message message, double badness) {
  if (says_once && message.severity != Severity::error && !said_.insert(to_string(message)).second) return;
  if (message.severity == Severity::error) ++errors_;
  if (message.severity == Severity::warning) ++warnings_;
  show(std::move(message), badness);
}

void Job::say_defect(Message message, double badness) {
  show(std::move(message), badness);
}

void Job::say_rest() {
  for (Message& message : tally_.rest()) tell(std::move(message));
}

void Job::show(Message message, double badness) {
  if (message.file.empty()) message.file = input.path == "-" ? "<stdin>" : input.path;
  if (!input.settings.empty())
    message.text += fmt::format(" [{}]", input.name().substr(input.path.size() + 1));
  if (options.all || tally_.take(message, badness)) tell(std::move(message));
}

void Job::tell(Message message) {
  const bool shown = message.severity == Severity::error ||
                     (message.severity == Severity::warning && !options.quiet) || options.verbose ||
                     (options.command == Command::info && !options.quiet);
  if (shown) channel_.send(packet::message, to_string(message));
  if (wants_report() || keeps_messages) report.messages.push_back(std::move(message));
}

void Job::say_all(const std::vector<Message>& messages) {
  for (const Message& message : messages) say(message);
}

void Job::forward(const Diagnostics& diagnostics) {
  int shown = 0;
  for (const Message& message : diagnostics.messages()) {
    if (message.severity == Severity::error) ++shown;
    say(message);
  }
  if (diagnostics.error_count() > shown)
    say(error(Kind::malformed,
              counted(static_cast<std::size_t>(diagnostics.error_count() - shown), "further error")));
}

void Job::progress(std::string_view verb, std::size_t done, std::size_t total) {
  progress(fmt::format("{} {} of {}", verb, done, total));
}

void Job::progress(std::string_view what) {
  const Clock::time_point now = Clock::now();
  if (now - last_progress_ < progress_interval) return;
  last_progress_ = now;
  channel_.send(packet::progress, fmt::format("{}: {}", input.path, what));
}

fabric::BuildOptions Job::build_options() const {
  fabric::BuildOptions build;
  build.ends = options.ends;
  build.tolerance = options.tolerance;
  build.full_digits = options.full_digits;
  build.detail = options.detail;
  build.as_published = options.as_published;
  build.gap = gap;
  return build;
}

void Job::limit_time(const formats::Descriptor& format) {
  if (options.timeout > 0) return;  // its process ends by that
  seconds = format.is_own ? text_timeout : foreign_timeout;
  channel_.send(packet::seconds, number_text(seconds));
  end_after(seconds);
}

std::optional<fabric::Fabric> Job::read(const CadLook& look) {
  Result<Source> source = Source::open(input.path);
  if (!source) return fail(source.error());
  if (wants_report()) {
    Result<std::string> digest =
        files_of(input.path).size() > 1 ? digest_of(input.path) : sha256(source->bytes());
    if (digest) report["sha256"] = *digest;  // a missing file is told by the reading
  }
  Result<const formats::Descriptor*> format = detect_readable(*source);
  if (!format) return fail(format.error());
  if (!is_own) limit_time(**format);
  Diagnostics diagnostics;
  std::optional<fabric::Fabric> fabric;
  // Libraries die of some files: that is a defect of the file, not of ours.
  const std::string_view library = (*format)->foreign_reader;
  if (!library.empty())
    channel_.send(packet::reader, fmt::format("{}{}{}", library, packet::separator, input.path));
  if (look.file) {
    look.file(*source, **format);
    for (const std::filesystem::path& file : further_files(input.path))
      if (const Result<Source> further = Source::open(file)) look.file(*further, **format);
  }
  if (!input.settings.empty()) {
    if ((*format)->read_with == nullptr)
      return fail(error(Kind::unsupported, fmt::format("this is {} ({}), which has no params to set",
                                                       (*format)->name, (*format)->title)));
    fabric = (*format)->read_with(*source, input.settings, diagnostics);
  } else if ((*format)->read_within != nullptr && options.tolerance > 0) {
    fabric = (*format)->read_within(*source, options.tolerance, diagnostics);
  } else if ((*format)->read_fabric != nullptr) {
    fabric = (*format)->read_fabric(*source, diagnostics);
  } else if ((*format)->read_points != nullptr) {
    if (const std::optional<fabric::Measured> points = (*format)->read_points(*source, diagnostics))
      fabric = fabric::fabric_of(*points, *source, diagnostics);
  } else if (std::optional<cad::Model> model = read_whole_model(**format, *source, diagnostics)) {
    if (look.model) look.model(*model, **format);
    fabric = fabric::fabric_of(std::move(*model), diagnostics);
  }
  if (!library.empty()) channel_.send(packet::reader, "");
  if (fabric) take_files(*fabric, *source, diagnostics);
  forward(diagnostics);
  if (!fabric && !diagnostics.has_errors())
    say(error(Kind::internal,
              fmt::format("the reader of {} gave neither a fabric nor a reason", (*format)->name)));
  if (diagnostics.has_errors()) return std::nullopt;
  if (fabric) report.units = fabric->units;
  return fabric;
}

// The hash of the input says nothing of the files that it names: with them in its settings it is never taken
// for done by `--resume`.
void Job::take_files(fabric::Fabric& fabric, const Source& source, Diagnostics& diagnostics) {
  for (const std::string& file : resolve_files(fabric, source, options.allow_outside, diagnostics))
    if (wants_report()) report.settings += " file=" + file;
  fabric::loft(fabric, diagnostics);
  if (diagnostics.has_errors()) return;
  gap = gap_of_constructions(options, fabric);
  fabric::settle_cell(fabric, build_options(), static_cast<int>(threads), diagnostics);
}

std::optional<fabric::YarnBuilder> Job::builder(const fabric::Fabric& fabric) {
  Diagnostics diagnostics;
  std::optional<fabric::YarnBuilder> made = fabric::YarnBuilder::create(fabric, build_options(), diagnostics);
  forward(diagnostics);
  if (!made) return std::nullopt;
  report["yarn_count"] = made->count();
  report["yarns"] = Json::array();
  if (made->count() == 0 && fabric::pieces_of(fabric).empty() && fabric.parts.empty() &&
      fabric.curves.empty())
    return fail(error(Kind::geometry, "there is nothing in this input"));
  return made;
}

namespace {

const yarn::Body& body_of(const yarn::Body& body) {
  return body;
}
const yarn::Body& body_of(const fabric::YarnBuilder::Shaped& yarn) {
  return *yarn.body;
}

// What `make` gives for each index, a few of them ahead, to `take` one by one.
template <class Made>
void make_each(Job& job, std::size_t count, std::string_view verb,
               const std::function<Result<Made>(std::size_t index)>& make,
               const std::function<bool(std::size_t index, Result<Made>&&)>& take) {
  constexpr std::size_t enough = std::size_t{4} << 20;  // bytes
  const std::size_t least = job.threads + 1, most = 8 * job.threads;
  std::vector<std::optional<Result<Made>>> made(most);
  std::atomic<std::size_t> largest = 0;  // bytes; 0: none is known
  std::atomic<bool> goes_on = true;
  for_each_in_order(
      count, most, [&] { return largest == 0 ? least : std::clamp(enough / largest, least, most); },
      static_cast<int>(job.threads),
      [&](std::size_t i, std::size_t slot) {
        if (goes_on) made[slot] = make(i);
        if (!made[slot] || !*made[slot]) return;
        const std::size_t size = body_of(**made[slot]).surface.points.size() * sizeof(Vec3);
        for (std::size_t known = largest; known < size && !largest.compare_exchange_weak(known, size);) {
        }
      },
      [&](std::size_t i, std::size_t slot) {
        if (!goes_on) return;
        job.progress(verb, i + 1, count);
        goes_on = take(i, *std::exchange(made[slot], std::nullopt));
      });
}

}  // namespace

void Job::build_each(const fabric::YarnBuilder& builder, std::string_view verb,
                     const std::function<bool(std::size_t index, Result<yarn::Body>&&)>& take) {
  make_each<yarn::Body>(
      *this, builder.count(), verb, [&](std::size_t i) { return builder.build(i); }, take);
}

void Job::for_each_yarn(const fabric::YarnBuilder& builder, std::string_view verb,
                        const std::function<bool(yarn::Body&&)>& take) {
  build_each(builder, verb, [&](std::size_t /*index*/, Result<yarn::Body>&& body) {
    if (!body) {
      say(body.error());
      return true;
    }
    say_all(body->messages);
    if (wants_report()) report["yarns"].push_back(yarn_json(*body, body->name, file_units()));
    return take(std::move(*body));
  });
}

void Job::for_each_shape(const fabric::YarnBuilder& builder, std::string_view verb,
                         const std::function<void(const fabric::YarnBuilder::Shaped&)>& take) {
  using Shaped = fabric::YarnBuilder::Shaped;
  make_each<Shaped>(
      *this, builder.count(), verb, [&](std::size_t i) { return builder.shape(i); },
      [&](std::size_t /*index*/, Result<Shaped>&& yarn) {
        if (!yarn) {
          say(yarn.error());
          return true;
        }
        say_all(yarn->body->messages);
        if (wants_report()) report["yarns"].push_back(yarn_json(*yarn->body, yarn->label.name, file_units()));
        take(*yarn);
        return true;
      });
}

std::optional<std::vector<yarn::Body>> Job::build_all(const fabric::YarnBuilder& builder) {
  std::vector<yarn::Body> bodies;
  for_each_yarn(builder, "building yarn", [&](yarn::Body&& body) {
    bodies.push_back(std::move(body));
    return true;
  });
  if (bodies.size() != builder.count()) return std::nullopt;
  return bodies;
}

std::optional<fabric::PieceShape> Job::build_piece(const fabric::Fabric& fabric, const fabric::Piece& piece,
                                                   bool defects) {
  Diagnostics diagnostics;
  std::optional<fabric::PieceShape> shape =
      fabric::build_piece(fabric, piece, options.tolerance, diagnostics);
  if (!defects) {
    forward(diagnostics);
  } else {
    for (const Message& message : diagnostics.messages())
      message.severity == Severity::error ? say_defect(message) : say(message);
  }
  if (shape && wants_report()) report["pieces"].push_back(piece_json(*shape, file_units(), options.table));
  return shape;
}

namespace {

bool may_be_skipped(Job& job, const std::string& earlier) {
  if (earlier.empty() || job.input.path == "-") return false;
  const Result<std::string> now = digest_of(job.input.path);
  if (!now.ok()) return false;
  std::vector<std::string> paths, without_optional;
  for (const PlannedOutput& output : job.outputs) {
    paths.push_back(output.path);
    if (output.as_companion == nullptr || !output.as_companion->is_of_load_cases)
      without_optional.push_back(output.path);
  }
  return is_still_valid(earlier, *now, job.report.settings, paths) ||
         is_still_valid(earlier, *now, job.report.settings, without_optional);
}

Verdict work(Job& job, const std::string& earlier) {
  if (may_be_skipped(job, earlier)) return Verdict::skipped;
  bool defective = false;
  switch (job.options.command) {
    case Command::convert:
    case Command::relax:
      convert(job);
      break;
    case Command::mesh:
      mesh(job);
      break;
    case Command::info:
      info(job);
      break;
    case Command::view:
      view(job);
      break;
    case Command::check:
      defective = check(job);
      break;
    case Command::roundtrip:
      defective = roundtrip(job);
      break;
    case Command::diff:
      return diff(job);
    case Command::edit:
      edit(job);
      break;
    case Command::sweep:
    case Command::report:
    case Command::formats:
    case Command::new_text:
    case Command::explain:
    case Command::help:
    case Command::show_version:
      break;  // no jobs
  }
  if (job.has_failed()) return Verdict::failed;
  return defective || job.unsolved ? Verdict::defect : Verdict::done;
}

}  // namespace

Verdict run_job(Job& job, const std::string& earlier, const Channel& channel) {
  const Clock::time_point start = Clock::now();
  if (job.wants_report()) {
    job.report.settings = settings_of(job.options);
    for (const fabric::Setting& setting : job.input.settings)
      job.report.settings += fmt::format(" {}={}", setting.name, setting.value);
  }
  Verdict verdict = Verdict::failed;
  if (Status whole = guarded(job.options, [&] { verdict = work(job, earlier); }); !whole)
    job.say(whole.error());
  job.say_rest();
  if (!job.wants_report()) return verdict;
  job.report["ok"] = verdict == Verdict::done;
  if (verdict == Verdict::defect) job.report["defect"] = true;
  job.report["seconds"] = std::chrono::duration<double>(Clock::now() - start).count();
  channel.send(packet::report, verdict == Verdict::skipped ? marked_skipped(earlier) : job.report.text());
  return verdict == Verdict::skipped && has_defect(earlier) ? Verdict::defect : verdict;
}

}  // namespace selvage::pipeline
