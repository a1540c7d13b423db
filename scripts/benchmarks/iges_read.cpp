// How fast IGES is read: our reader (a file to a cad::Model), OpenCASCADE's reader (a file to its entities,
// and on to its shapes), and a bare loop of std::from_chars over the same parameter lines. All in one run, on
// the same file, which is in the system's cache; medians of several repeats; one JSON object to standard
// output.
//
//   iges_read [--repeats N] [--sizes N,N,...] [--folder DIR] [--no-occt]
#include <fmt/format.h>
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
#include <string>
#include <vector>

#include "core/output.h"
#include "core/source.h"
#include "formats/registry.h"
#include "scripts/benchmarks/cloth.h"
#include "scripts/benchmarks/measuring.h"

namespace {

using namespace selvage;
using benchmarks::Cloth;
using benchmarks::fail;
using benchmarks::measure;
using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Outcome {
  double seconds = 0;
  double parsing = 0;  // OpenCASCADE: of them, until its entities are there
  double checksum = 0;
  std::uint64_t surfaces = 0;
};
using Measured = benchmarks::Measured<Outcome>;

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
  benchmarks::Arguments given;
  given.read(count, words);
  ::Message::DefaultMessenger()->ChangePrinters().Clear();

  const std::string path = fmt::format("{}/selvage-bench-{}.igs", given.folder, ::getpid());
  const std::string small = fmt::format("{}/selvage-bench-{}-small.igs", given.folder, ::getpid());
  write_file(small, 8);
  std::vector<std::string> rows;
  for (const int yarns : given.sizes) {
    const std::uint64_t bytes = write_file(path, yarns);
    std::vector<Measured> a, b, c;
    measure(ours, small, path);  // warm-up
    for (int r = 0; r < given.repeats; ++r) {
      a.push_back(measure(ours, small, path));
      b.push_back(measure(bare, small, path));
      if (given.is_occt_repeated(r, yarns)) c.push_back(measure(occt, small, path));
    }
    const Measured own = median(a);
    if (own.outcome.surfaces != 3 * static_cast<std::uint64_t>(yarns)) fail("not all surfaces were read");
    std::string ratios = fmt::format(R"(, "time_to_bare_loop": {:.3f})", median_ratio(a, b));
    if (given.with_occt) ratios += fmt::format(R"(, "times_occt": {:.1f})", median_ratio(c, a));
    rows.push_back(row("selvage", yarns, bytes, own, ratios));
    rows.push_back(row("bare loop", yarns, bytes, median(b)));
    if (given.with_occt) {
      const Measured other = median(c);
      rows.push_back(row("OpenCASCADE", yarns, bytes, other,
                         fmt::format(R"(, "parsing_seconds": {:.6g})", other.outcome.parsing)));
    }
  }
  ::unlink(path.c_str());
  ::unlink(small.c_str());
  benchmarks::print_rows("iges_read", "\"control_points\": [18, 16], ", given.repeats, rows);
  return 0;
}
