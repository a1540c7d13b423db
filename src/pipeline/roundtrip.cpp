// `selvage roundtrip`: written, read back, compared; for every surface format.
#include "pipeline/roundtrip.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "cad/compare.h"
#include "core/readable.h"
#include "core/words.h"
#include "formats/registry.h"
#include "pipeline/detect.h"
#include "pipeline/differences.h"
#include "pipeline/facts.h"
#include "pipeline/subject.h"
#include "pipeline/table.h"

namespace selvage::pipeline {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t shown_differences = 20;

// What was read of an input: as it is compared, and what is told of its yarns.
struct Reading {
  cad::Subject subject;
  std::size_t yarns = 0, closed = 0;
  double volume = 0;  // mm3
};

struct Original {
  fabric::Fabric fabric;
  std::vector<yarn::Body> bodies;
  std::vector<fabric::PieceShape> pieces;
  Reading reading;
};

void take_facts(Reading& reading, const yarn::Body& body, Unit units) {
  const double mm = millimetres_per(units);
  ++reading.yarns;
  if (is_closed(body)) ++reading.closed;
  reading.volume += body.volume * mm * mm * mm;
}

std::optional<Original> read_original(Job& job) {
  std::optional<fabric::Fabric> fabric = job.read();
  if (!fabric) return std::nullopt;
  Original original;
  original.fabric = std::move(*fabric);
  Onlooker onlooker;
  onlooker.yarn = [&](const yarn::Body& body) {
    take_facts(original.reading, body, original.fabric.units);
    original.bodies.push_back(body);
  };
  onlooker.piece = [&](const fabric::PieceShape& piece) { original.pieces.push_back(piece); };
  std::optional<cad::Subject> subject = subject_of(job, original.fabric, onlooker);
  if (!subject) return std::nullopt;
  original.reading.subject = std::move(*subject);
  return original;
}

// The same yarns as control grids, and nothing of the statements that made them.
fabric::Fabric as_grids(const Original& original) {
  fabric::Fabric grids;
  grids.title = original.fabric.title;
  grids.units = original.fabric.units;
  grids.units_given = true;
  for (const yarn::Body& body : original.bodies) {
    auto& yarn = std::get<fabric::Yarn>(grids.items.emplace_back(fabric::yarn_like(body)));
    yarn.own.color = body.color;
    yarn.shape = std::make_shared<const yarn::Body>(body);
  }
  for (const fabric::Piece* piece : fabric::pieces_of(original.fabric)) grids.items.emplace_back(*piece);
  return grids;
}

Status add_all(const Original& original, formats::BodyWriter& writer) {
  const auto added = [&](const auto& list, const auto& add) -> Status {
    for (const auto& item : list)
      if (Status status = add(item); !status) return status;
    return {};
  };
  if (Status s = added(original.bodies, [&](const auto& x) { return writer.add(x); }); !s) return s;
  if (Status s = added(original.pieces, [&](const auto& x) { return writer.add_piece(x); }); !s) return s;
  if (Status s = added(original.fabric.parts, [&](const auto& x) { return writer.add_part(x); }); !s)
    return s;
  return added(original.fabric.curves, [&](const auto& x) { return writer.add_curve(x); });
}

Status write(const Job& job, const Original& original, const Trip& trip, const std::filesystem::path& path) {
  Result<OutputFile> output = OutputFile::create(path);
  if (!output) return output.error();
  if (trip.format->write_fabric != nullptr) {
    const Result<formats::WriteFacts> facts = trip.format->write_fabric(as_grids(original), *output);
    if (!facts) return facts.error();
    return output->commit();
  }
  formats::SurfaceOptions surface;
  surface.title = original.fabric.title.value_or("");
  surface.file_name = path.filename().string();
  surface.units = original.fabric.units;
  surface.expected_bodies = original.bodies.size();
  surface.date = original.fabric.date;
  surface.has_others =
      !original.pieces.empty() || !original.fabric.parts.empty() || !original.fabric.curves.empty();
  surface.tolerance = fabric::tolerance_of(original.fabric, job.build_options());
  if (trip.form != nullptr) surface.own.set(*trip.form);
  Result<std::unique_ptr<formats::BodyWriter>> writer = trip.format->open_bodies(*output, surface);
  if (!writer) return writer.error();
  if (Status status = add_all(original, **writer); !status) return status;
  if (const Result<formats::WriteFacts> facts = (*writer)->finish(); !facts) return facts.error();
  return output->commit();
}

// By a job of its own, whose warnings were told before. Nothing when it cannot be read.
std::optional<Reading> read_back(const Job& job, const std::filesystem::path& path, std::string& failure) {
  const Input input{path.string(), {}};
  Options quiet = job.options;
  quiet.quiet = true;
  quiet.verbose = false;
  Job again(quiet, input, job.outputs, job.channel());
  again.threads = job.threads;
  again.keeps_messages = true;
  again.is_own = true;
  Reading reading;
  const std::optional<fabric::Fabric> fabric = again.read();
  if (fabric) {
    Onlooker onlooker;
    onlooker.yarn = [&](const yarn::Body& body) { take_facts(reading, body, fabric->units); };
    std::optional<cad::Subject> subject = subject_of(again, *fabric, onlooker);
    if (subject && !again.has_failed()) {
      reading.subject = std::move(*subject);
      return reading;
    }
  }
  for (const Message& message : again.report.messages)
    if (message.severity == Severity::error) failure += message.text + "\n";
  if (failure.empty()) failure = "it was not read back\n";
  return std::nullopt;
}

// How what came back is like what went. Lengths in mm.
struct Likeness {
  bool equal = false;
  double largest = 0;  // deviation: a bound on the distance, or of control points
  std::string largest_of;
  Json yarns = Json::array();
  std::vector<std::string> differences, notes;
};

class Traveller {
 public:
  Traveller(Job& job, const Original& original) : job_(job), original_(original) {}

  bool travel(const Trip& trip);  // true: it came back different
  [[nodiscard]] std::string table() const { return table_.text(); }

 private:
  Likeness compare(Reading& back);
  void tell(const Trip& trip, const Reading& back, const Likeness& likeness, double seconds);
  void tell_failure(const Trip& trip, const std::string& reason, double seconds);

  Job& job_;
  const Original& original_;
  Table table_{{"format", "yarns", "closed before", "closed after", "volume before", "volume after",
                "largest deviation", "of", "verdict"}};
};

Likeness Traveller::compare(Reading& back) {
  const Reading& before = original_.reading;
  const Unit units = original_.fabric.units;
  const double mm = millimetres_per(units);
  cad::CompareOptions options;
  options.tolerance = job_.options.difference_tolerance;
  options.threads = static_cast<int>(job_.threads);
  options.progress = job_.progress_of("comparing");
  Likeness likeness;
  std::vector<std::string>& differences = likeness.differences;
  if (back.subject.model.units != units) {
    differences.push_back(fmt::format("its unit came back as {}", name_of(back.subject.model.units)));
    convert_lengths(back.subject, units);
  }
  if (back.closed != before.closed)
    differences.push_back(fmt::format("closed yarns: {} before, {} after", before.closed, back.closed));
  const cad::Comparison found = cad::compare(before.subject, back.subject, options);
  likeness.equal = found.differences.empty() && differences.empty();
  for (const cad::Comparison::Match& match : found.matches) {
    const double deviation = match.at_most * mm;
    if (match.what == cad::Thing::Kind::yarn)
      likeness.yarns.push_back({{"name", match.name}, {"deviation", if_finite(deviation)}});
    if (deviation <= likeness.largest) continue;
    likeness.largest = deviation;
    likeness.largest_of = match.name;
  }
  for (const cad::Difference& difference : found.differences) {
    if (differences.size() == shown_differences) break;
    differences.push_back(line_of(difference, units));
  }
  if (found.differences.size() > differences.size())
    differences.push_back(fmt::format("... {} differences in all", found.differences.size()));
  likeness.notes = found.notes;
  return likeness;
}

void Traveller::tell(const Trip& trip, const Reading& back, const Likeness& likeness, double seconds) {
  const Reading& before = original_.reading;
  job_.report["roundtrips"].push_back(
      {{"format", trip.name},
       {"seconds", seconds},
       {"equal", likeness.equal},
       {"largest_deviation", if_finite(likeness.largest)},
       {"largest_of", if_true(!likeness.largest_of.empty(), likeness.largest_of)},
       {"closed", {before.closed, back.closed}},
       {"volume", {before.volume, back.volume}},
       {"yarn_count", {before.yarns, back.yarns}},
       {"yarns", likeness.yarns},
       {"differences", likeness.differences},
       {"notes", if_true(!likeness.notes.empty(), likeness.notes)}});
  table_.add(
      {trip.name, std::to_string(before.yarns), std::to_string(before.closed), std::to_string(back.closed),
       cell(before.volume), cell(back.volume), likeness.largest == 0 ? "0" : cell(likeness.largest),
       likeness.largest_of.empty() ? "-" : likeness.largest_of, likeness.equal ? "equal" : "different"});
  for (const std::string& line : likeness.differences)
    job_.say_defect(error(Kind::geometry, fmt::format("through {}: {}", trip.name, line)));
}

void Traveller::tell_failure(const Trip& trip, const std::string& reason, double seconds) {
  const Reading& before = original_.reading;
  job_.report["roundtrips"].push_back({{"format", trip.name}, {"seconds", seconds}, {"error", reason}});
  table_.add({trip.name, std::to_string(before.yarns), std::to_string(before.closed), "-",
              cell(before.volume), "-", "-", "-", "failed"});
}

bool Traveller::travel(const Trip& trip) {
  const Clock::time_point start = Clock::now();
  const std::filesystem::path path =
      std::filesystem::path(job_.options.scratch) /
      fmt::format("{}-{}{}", job_.number, trip.name, trip.format->extensions.front());
  std::string failure;
  std::optional<Reading> back;
  std::optional<Likeness> likeness;
  if (Status written = write(job_, original_, trip, path); !written) {
    failure = written.error().text;
    job_.say(written.error());
  } else if ((back = read_back(job_, path, failure))) {
    likeness = compare(*back);
  } else {
    job_.say(error(Kind::internal, fmt::format("what was written as {} cannot be read back", trip.name)));
  }
  std::error_code ignored;  // the folder goes at the end in any case
  std::filesystem::remove(path, ignored);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  if (likeness)
    tell(trip, *back, *likeness, seconds);
  else
    tell_failure(trip, failure, seconds);
  return likeness && !likeness->equal;
}

bool comes_and_goes(const formats::Descriptor& format) {
  return format.is_readable() && format.carries_surfaces &&
         (format.open_bodies != nullptr || format.write_fabric != nullptr);
}

std::vector<Trip> all_trips() {
  std::vector<Trip> all;
  for (const formats::Descriptor* format : formats::all_formats()) {
    if (!comes_and_goes(*format)) continue;
    all.push_back({std::string(format->name), format});
    if (format->other_form != nullptr)
      all.push_back({std::string(format->other_form->word()), format, format->other_form});
  }
  return all;
}

// What a text of yarns cannot hold.
bool has_only_surfaces(const Original& original) {
  return original.fabric.items.empty() && original.fabric.parts.size() + original.fabric.curves.size() > 0;
}

std::string names_of(const std::vector<Trip>& trips) {
  std::vector<std::string> names;
  names.reserve(trips.size());
  for (const Trip& trip : trips) names.push_back(trip.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::string trip_names() {
  return names_of(all_trips());
}

Result<std::vector<Trip>> wanted_trips(const Options& options) {
  std::vector<Trip> all = all_trips();
  if (options.formats.empty()) return all;
  std::vector<Trip> wanted;
  for (const std::string_view name : split(options.formats, ',')) {
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const Trip& trip) { return trip.name == name; });
    if (found == all.end())
      return error(Kind::usage, fmt::format("'{}' is no format of surfaces that is both written and read: {}",
                                            name, names_of(all)));
    wanted.push_back(*found);
  }
  return wanted;
}

bool roundtrip(Job& job) {
  const Result<std::vector<Trip>> trips = wanted_trips(job.options);
  if (!trips) return job.fail(trips.error());
  const std::optional<Original> original = read_original(job);
  if (!original) return false;
  Traveller traveller(job, *original);
  bool is_different = false;
  std::size_t number = 0;
  for (const Trip& trip : *trips) {
    // Of all formats those that hold it; who names one is told why not.
    if (job.options.formats.empty() && trip.format->write_fabric != nullptr && has_only_surfaces(*original))
      continue;
    job.progress(trip.name, ++number, trips->size());
    is_different = traveller.travel(trip) || is_different;
  }
  job.print(
      fmt::format("{}: deviations in mm, volumes in mm3\n{}", readable(job.input.path), traveller.table()));
  return is_different;
}

}  // namespace selvage::pipeline
