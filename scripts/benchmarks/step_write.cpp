// How STEP writing grows with the number of yarns: yarns of 18 x 16 control points with patch ends, each size
// in a process of its own so that the peak memory is that job's. Medians of several repeats; one JSON object
// to standard output.
//
//   step_write [--repeats N] [--yarns N,N,...] [--folder DIR]
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "formats/step/step.h"
#include "yarn/finish.h"
#include "yarn/grid.h"

namespace {

using namespace selvage;

[[noreturn]] void fail(const std::string& text) {
  fmt::print(stderr, "error: {}\n", text);
  std::exit(1);
}
void require(Status status) {
  if (!status.ok()) fail(to_string(status.error()));
}

// Yarn k of a cloth: 16 sections of 16 points (18 in clamped form) that wave along y.
yarn::Body cloth_yarn(int k) {
  yarn::GridNet net;
  net.sections = net.per_section = 16;
  const double phase = std::numbers::pi * (k % 2);
  for (int j = 0; j < 16; ++j) {
    const double along = 8.2193 * j / 15;
    for (int i = 0; i < 16; ++i) {
      const double angle = 2 * std::numbers::pi * i / 16;
      net.points.emplace_back(0.5137 * k + 0.2011 * std::cos(angle), along,
                              0.1317 * std::cos(along * 6.1152 + phase) + 0.1003 * std::sin(angle));
    }
  }
  yarn::Body body;
  body.name = fmt::format("warp_{}", k + 1);
  require(yarn::fill_from_grid(body, net));
  require(yarn::finish(body, yarn::EndStyle::patch));
  return body;
}

struct Measured {
  double seconds = 0;      // wall time of all calls of the writer; the making of the yarns is not timed
  double cpu_seconds = 0;  // the same, of the processor
  std::uint64_t bytes = 0;
  double peak_mib = 0;  // largest resident set
};

double clock_seconds(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Measured write_cloth(int yarns, const std::string& path) {
  Measured measured;
  double wall = 0, cpu = 0;
  const auto start = [&] {
    wall = clock_seconds(CLOCK_MONOTONIC);
    cpu = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
  };
  const auto stop = [&] {
    measured.seconds += clock_seconds(CLOCK_MONOTONIC) - wall;
    measured.cpu_seconds += clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
  };
  start();
  Result<OutputFile> output = OutputFile::create(path);
  if (!output) fail(to_string(output.error()));
  auto writer = formats::step::descriptor().open_bodies(*output, {});
  if (!writer) fail(to_string(writer.error()));
  stop();
  for (int k = 0; k < yarns; ++k) {
    const yarn::Body body = cloth_yarn(k);
    start();
    require((*writer)->add(body));
    stop();
  }
  start();
  auto facts = (*writer)->finish();
  if (!facts) fail(to_string(facts.error()));
  stop();
  measured.bytes = output->size();
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  measured.peak_mib = static_cast<double>(usage.ru_maxrss) / 1024;
  return measured;
}

Measured in_own_process(int yarns, const std::string& path) {
  int ends[2];
  if (::pipe(ends) != 0) fail("pipe");
  const pid_t child = ::fork();
  if (child == 0) {
    const Measured measured = write_cloth(yarns, path);
    ::_exit(::write(ends[1], &measured, sizeof measured) == sizeof measured ? 0 : 1);
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

std::vector<int> numbers_in(const std::string& words) {
  std::vector<int> numbers;
  for (std::size_t from = 0; from <= words.size();) {
    const std::size_t comma = std::min(words.find(',', from), words.size());
    numbers.push_back(std::atoi(words.substr(from, comma - from).c_str()));
    if (numbers.back() < 1) fail("not a number of yarns: " + words);
    from = comma + 1;
  }
  return numbers;
}

}  // namespace

int main(int count, char** words) {
  int repeats = 3;
  std::vector<int> sizes = {64, 512, 2048};
  std::string folder = ".";
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string word = words[i], value = words[i + 1];
    if (word == "--repeats")
      repeats = numbers_in(value).front();
    else if (word == "--yarns")
      sizes = numbers_in(value);
    else if (word == "--folder")
      folder = value;
    else
      fail("unknown word " + word);
  }
  std::string rows;
  for (const int yarns : sizes) {
    std::vector<Measured> all;
    for (int k = 0; k < repeats; ++k) all.push_back(in_own_process(yarns, folder + "/cloth.stp"));
    std::sort(all.begin(), all.end(),
              [](const Measured& a, const Measured& b) { return a.seconds < b.seconds; });
    const Measured& m = all[all.size() / 2];
    if (!rows.empty()) rows += ",\n";
    rows += fmt::format(
        R"(  {{"yarns": {}, "seconds": {:.6g}, "cpu_seconds": {:.6g}, "bytes": {}, "yarns_per_s": {:.0f}, "peak_rss_mib": {:.1f}}})",
        yarns, m.seconds, m.cpu_seconds, m.bytes, yarns / m.seconds, m.peak_mib);
  }
  fmt::print("{{\"benchmark\": \"step_write\", \"repeats\": {}, \"rows\": [\n{}\n]}}\n", repeats, rows);
}
