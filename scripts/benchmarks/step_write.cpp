// How STEP writing grows with the number of yarns, each size in a process of its own so that the peak memory
// is that job's: by our writer, of yarns that repeat as a weave's do and of yarns that are all different, and
// by OpenCASCADE. Medians of several repeats; one JSON object to standard output.
//
//   step_write [--repeats N] [--sizes N,N,...] [--folder DIR] [--no-occt]
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <string>
#include <vector>

#include "formats/registry.h"
#include "scripts/benchmarks/cloth.h"
#include "scripts/benchmarks/measuring.h"

namespace {

using namespace selvage;
using benchmarks::fail;
using benchmarks::measure;

void require(const Status& status) {
  if (!status.ok()) fail(to_string(status.error()));
}

struct Job {
  int yarns;
  std::string path;
  bool by_occt = false, repeats = true;
};

struct Outcome {
  double seconds = 0;      // wall time of all calls of the writer; the making of the yarns is not timed
  double cpu_seconds = 0;  // the same, of the processor
  std::uint64_t bytes = 0;
};
using Measured = benchmarks::Measured<Outcome>;

double clock_seconds(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Outcome written(const Job& job) {
  Outcome outcome;
  benchmarks::Cloth cloth;
  double wall = 0, cpu = 0;
  const auto start = [&] {
    wall = clock_seconds(CLOCK_MONOTONIC);
    cpu = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
  };
  const auto stop = [&] {
    outcome.seconds += clock_seconds(CLOCK_MONOTONIC) - wall;
    outcome.cpu_seconds += clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
  };
  start();
  Result<OutputFile> output = OutputFile::create(job.path);
  if (!output) fail(to_string(output.error()));
  formats::SurfaceOptions options;
  options.has_others = job.by_occt;
  auto writer = formats::step::descriptor().open_bodies(*output, options);
  if (!writer) fail(to_string(writer.error()));
  stop();
  for (int k = 0; k < job.yarns; ++k) {
    const yarn::Body& body = cloth.yarn(k, job.repeats ? 0.1317 : 0.1317 * (1 + 1e-4 * k));
    start();
    require((*writer)->add(body));
    stop();
  }
  start();
  auto facts = (*writer)->finish();
  if (!facts) fail(to_string(facts.error()));
  stop();
  outcome.bytes = output->size();
  return outcome;
}

}  // namespace

int main(int count, char** words) {
  benchmarks::Arguments given;
  given.repeats = 3;
  given.sizes = {64, 512, 2048};
  given.read(count, words);
  std::vector<std::string> rows;
  for (const int yarns : given.sizes) {
    const Job job{yarns, given.folder + "/cloth.stp"};
    Job occt = job, all_different = job;
    occt.by_occt = true;
    all_different.repeats = false;
    double occt_seconds = 0;  // of the processor: what else the machine does is no part of the ratio
    for (const auto& [writer, its] : {std::pair{"OpenCASCADE", occt}, std::pair{"selvage", job},
                                      std::pair{"selvage, all different", all_different}}) {
      if (its.by_occt && !given.with_occt) continue;
      Job small = its;
      small.yarns = std::min(yarns, 8);
      std::vector<Measured> all;
      for (int k = 0; k < given.repeats; ++k) all.push_back(measure(written, small, its));
      const Measured m = median(all);
      if (its.by_occt) occt_seconds = m.outcome.cpu_seconds;
      const std::string ratio =
          its.by_occt || occt_seconds == 0
              ? ""
              : fmt::format(R"(, "times_occt": {:.1f})", occt_seconds / m.outcome.cpu_seconds);
      rows.push_back(fmt::format(
          R"(  {{"writer": "{}", "yarns": {}, "seconds": {:.6g}, "cpu_seconds": {:.6g}, "bytes": {}, "yarns_per_s": {:.0f}, "peak_rss_growth_mib": {:.1f}{}}})",
          writer, yarns, m.outcome.seconds, m.outcome.cpu_seconds, m.outcome.bytes, yarns / m.outcome.seconds,
          m.peak_mib, ratio));
    }
  }
  benchmarks::print_rows("step_write", "", given.repeats, rows);
}
