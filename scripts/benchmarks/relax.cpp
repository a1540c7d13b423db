// How long it takes to move the loops of the published jersey apart, and whether the cost of a loop stays the
// same with the size of the cloth. Moved apart means: the exact search finds no overlap afterwards, and all
// bounds hold; anything else is an error. One JSON object.
//
//   relax [--sizes N,N,...] [--threads N]
#include "contact/relax.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "scripts/benchmarks/built.h"

namespace {

using namespace selvage;

using benchmarks::fail;

std::vector<yarn::Body> published_jersey(int size) {
  fabric::BuildOptions options;
  options.as_published = true;
  return benchmarks::built(benchmarks::jersey(size), options);
}

double largest(const std::vector<contact::YarnChange>& changes, double contact::YarnChange::*value) {
  double most = 0.0;
  for (const contact::YarnChange& change : changes) most = std::max(most, std::abs(change.*value));
  return most;
}

}  // namespace

int main(int count, char** words) {
  benchmarks::Arguments given;
  given.sizes = {6, 12, 25, 50};
  given.read(count, words);
  std::string rows;
  for (const int size : given.sizes) {
    std::vector<yarn::Body> bodies = published_jersey(size);
    contact::RelaxOptions options;
    options.threads = given.threads;
    const auto begin = std::chrono::steady_clock::now();
    const Result<contact::Relaxation> relaxed = contact::relax(std::move(bodies), options);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (!relaxed) fail(to_string(relaxed.error()));
    if (!relaxed->solved || relaxed->after.overlaps > 0) fail("not solved: " + relaxed->reason);
    rows += fmt::format(
        "{}  {{\"size\": {}, \"seconds\": {:.4g}, \"milliseconds_a_loop\": {:.4g}, \"steps\": {}, "
        "\"overlaps\": {}, "
        "\"depth\": {:.4g}, \"area\": {:.3g}, \"length\": {:.3g}, \"volume\": {:.3g}, \"peak_rss_mib\": "
        "{:.0f}}}",
        rows.empty() ? "" : ",\n", size, seconds, 1e3 * seconds / size / size, relaxed->iterations,
        relaxed->before.overlaps, relaxed->before.depth,
        largest(relaxed->changes, &contact::YarnChange::area),
        largest(relaxed->changes, &contact::YarnChange::length),
        largest(relaxed->changes, &contact::YarnChange::volume),
        static_cast<double>(benchmarks::peak_kib()) / 1024.0);
  }
  fmt::print("{{\"benchmark\": \"relax\", \"threads\": {}, \"rows\": [\n{}\n]}}\n", given.threads, rows);
  return 0;
}
