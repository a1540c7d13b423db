// How fast IGES is read: our reader (a file to a cad::Model), OpenCASCADE's reader (a file to its entities,
// and on to its shapes), and a bare loop of std::from_chars over the same parameter lines. All in one run, on
// the same file, which is in the system's cache; medians of several repeats; one JSON object to standard
// output.
//
//   iges_read [--repeats N] [--yarns N,N,...] [--folder DIR] [--no-occt]
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <IGESControl_Controller.hxx>
#include <IGESControl_Reader.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "core/output.h"
#include "core/source.h"
#include "formats/iges/iges.h"
#include "scripts/benchmarks/cloth.h"

namespace {

using namespace selvage;
using benchmarks::Cloth;
using Clock = std::chrono::steady_clock;

[[noreturn]] void fail(const std::string& text) {
  fmt::print(stderr, "error: {}\n", text);
  std::exit(1);
}

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Outcome {
  double seconds = 0;
  double parsing = 0;  // OpenCASCADE: of them, until its entities are there
  double checksum = 0;
  std::uint64_t surfaces = 0;
};

Outcome ours(const std::string& path) {
  Outcome outcome;
  const Clock::time_point start = Clock::now();
  const Result<Source> source = Source::open(path);
  if (!source) fail(to_string(source.error()));
  Diagnostics diagnostics;
  const std::optional<cad::Model> model = formats::iges::descriptor().read_model(*source, diagnostics);
  outcome.seconds = since(start);
  if (!model) fail(to_string(*diagnostics.first_error()));
  outcome.surfaces = model->face_count();
  outcome.checksum = model->parts.back().faces.back().surface.points.back().x();
  return outcome;
}

// Every number in columns 1-64 of the parameter lines; what is none is passed over character by character.
Outcome bare(const std::string& path) {
  Outcome outcome;
  const Clock::time_point start = Clock::now();
  const Result<Source> source = Source::open(path);
  if (!source) fail(to_string(source.error()));
  const std::string_view bytes = source->bytes();
  for (std::size_t line = 0; line + 80 <= bytes.size(); line += 81) {
    if (bytes[line + 72] != 'P') continue;
    const char* at = bytes.data() + line;
    const char* const end = at + 64;
    while (at < end) {
      double value = 0;
      const auto result = std::from_chars(at, end, value);
      if (result.ptr == at) {
        ++at;
        continue;
      }
      outcome.checksum += value;
      at = result.ptr + 1;
    }
  }
  outcome.seconds = since(start);
  return outcome;
}

Outcome occt(const std::string& path) {
  IGESControl_Controller::Init();
  Outcome outcome;
  const Clock::time_point start = Clock::now();
  IGESControl_Reader reader;
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) fail("OpenCASCADE does not read " + path);
  outcome.parsing = since(start);
  reader.TransferRoots();
  outcome.seconds = since(start);
  outcome.surfaces = static_cast<std::uint64_t>(reader.NbShapes());
  return outcome;
}

struct Measured {
  Outcome outcome;
  double peak_mib = 0;  // growth of the largest resident set over that of the process before the job
};

long peak_kib() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

// In a process of its own, so that the peak memory is this job's; on a small file first, since starting up is
// no reading.
Measured measure(const std::function<Outcome(const std::string&)>& run, const std::string& small,
                 const std::string& path) {
  int ends[2];
  if (::pipe(ends) != 0) fail("pipe");
  const pid_t child = ::fork();
  if (child == 0) {
    run(small);
    const long before = peak_kib();
    Measured measured{run(path), 0};
    measured.peak_mib = static_cast<double>(peak_kib() - before) / 1024;
    const bool sent = ::write(ends[1], &measured, sizeof measured) == sizeof measured;
    ::_exit(sent ? 0 : 1);
  }
  ::close(ends[1]);
  Measured measured;
  const bool got = ::read(ends[0], &measured, sizeof measured) == sizeof measured;
  ::close(ends[0]);
  int state = 0;
  ::waitpid(child, &state, 0);
  if (!got || state != 0) fail("a job of the benchmark failed");
  return measured;
}

Measured median(std::vector<Measured> all) {
  std::sort(all.begin(), all.end(),
            [](const Measured& a, const Measured& b) { return a.outcome.seconds < b.outcome.seconds; });
  return all[all.size() / 2];
}

// The median of the ratios of time of neighbouring runs: what else the machine does changes slowly against
// them.
double median_ratio(const std::vector<Measured>& above, const std::vector<Measured>& below) {
  std::vector<double> ratios;
  for (std::size_t r = 0; r < std::min(above.size(), below.size()); ++r)
    ratios.push_back(above[r].outcome.seconds / below[r].outcome.seconds);
  std::sort(ratios.begin(), ratios.end());
  return ratios[ratios.size() / 2];
}

std::uint64_t write_file(const std::string& path, int yarns) {
  Result<OutputFile> output = OutputFile::create(path);
  if (!output) fail(to_string(output.error()));
  formats::SurfaceOptions options;
  options.file_name = "cloth.igs";
  auto writer = formats::iges::descriptor().open_bodies(*output, options);
  if (!writer) fail(to_string(writer.error()));
  Cloth cloth;
  for (int k = 0; k < yarns; ++k)
    if (const Status added = (*writer)->add(cloth.yarn(k)); !added.ok()) fail(to_string(added.error()));
  if (const auto facts = (*writer)->finish(); !facts) fail(to_string(facts.error()));
  const std::uint64_t size = output->size();
  if (const Status kept = output->commit(); !kept.ok()) fail(to_string(kept.error()));
  return size;
}

std::string row(std::string_view reader, int yarns, std::uint64_t bytes, const Measured& m,
                const std::string& more = {}) {
  const double s = m.outcome.seconds;
  return fmt::format(
      R"(  {{"reader": "{}", "yarns": {}, "seconds": {:.6g}, "bytes": {}, "mb_per_s": {:.1f}, )"
      R"("surfaces_per_s": {:.0f}, "peak_rss_growth_mib": {:.1f}{}}})",
      reader, yarns, s, bytes, static_cast<double>(bytes) / s / 1e6, 3 * yarns / s, m.peak_mib, more);
}

}  // namespace

int main(int count, char** words) {
  int repeats = 9;
  std::vector<int> sizes = {8, 64, 512, 2048};
  std::string folder = ".";
  bool with_occt = true;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--no-occt") {
      with_occt = false;
      continue;
    }
    if (i + 1 == count) fail("a value is missing after " + word);
    const char* value = words[++i];
    if (word == "--repeats") {
      repeats = std::max(1, std::atoi(value));
    } else if (word == "--folder") {
      folder = value;
    } else if (word == "--yarns") {
      sizes.clear();
      for (char* part = std::strtok(words[i], ","); part != nullptr; part = std::strtok(nullptr, ","))
        sizes.push_back(std::max(1, std::atoi(part)));
    } else {
      fail("unknown word " + word);
    }
  }
  ::Message::DefaultMessenger()->ChangePrinters().Clear();

  const std::string path = fmt::format("{}/selvage-bench-{}.igs", folder, ::getpid());
  const std::string small = fmt::format("{}/selvage-bench-{}-small.igs", folder, ::getpid());
  write_file(small, 8);
  std::vector<std::string> rows;
  for (const int yarns : sizes) {
    const std::uint64_t bytes = write_file(path, yarns);
    std::vector<Measured> a, b, c;
    measure(ours, small, path);  // warm-up
    for (int r = 0; r < repeats; ++r) {
      a.push_back(measure(ours, small, path));
      b.push_back(measure(bare, small, path));
      if (with_occt && (r < 5 || yarns <= 64)) c.push_back(measure(occt, small, path));
    }
    const Measured own = median(a);
    if (own.outcome.surfaces != 3 * static_cast<std::uint64_t>(yarns)) fail("not all surfaces were read");
    std::string ratios = fmt::format(R"(, "time_to_bare_loop": {:.3f})", median_ratio(a, b));
    if (with_occt) ratios += fmt::format(R"(, "times_occt": {:.1f})", median_ratio(c, a));
    rows.push_back(row("selvage", yarns, bytes, own, ratios));
    rows.push_back(row("bare loop", yarns, bytes, median(b)));
    if (with_occt) {
      const Measured other = median(c);
      rows.push_back(row("OpenCASCADE", yarns, bytes, other,
                         fmt::format(R"(, "parsing_seconds": {:.6g})", other.outcome.parsing)));
    }
  }
  ::unlink(path.c_str());
  ::unlink(small.c_str());
  std::string all;
  for (const std::string& text : rows) all += (all.empty() ? "" : ",\n") + text;
  fmt::print(
      "{{\"benchmark\": \"iges_read\", \"control_points\": [18, 16], \"repeats\": {}, \"rows\": "
      "[\n{}\n]}}\n",
      repeats, all);
  return 0;
}
