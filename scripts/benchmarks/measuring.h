// What benchmarks share: the end of the program with what went wrong, its words, a job in a process of its
// own, medians.
#pragma once

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <type_traits>
#include <vector>

namespace selvage::benchmarks {

[[noreturn]] inline void fail(const std::string& text) {
  fmt::print(stderr, "error: {}\n", text);
  std::exit(1);
}

inline std::vector<int> numbers_in(const std::string& words) {
  std::vector<int> numbers;
  for (std::size_t from = 0; from <= words.size();) {
    const std::size_t comma = std::min(words.find(',', from), words.size());
    numbers.push_back(std::atoi(words.substr(from, comma - from).c_str()));
    if (numbers.back() < 1) fail("not a number from 1: " + words);
    from = comma + 1;
  }
  return numbers;
}

// [--repeats N] [--sizes N,N,...] [--folder DIR] [--threads N] [--no-occt]: a benchmark names those that it
// has.
struct Arguments {
  int repeats = 9;
  std::vector<int> sizes = {8, 64, 512, 2048};
  std::string folder = ".";
  int threads = 2;
  bool with_occt = true;

  void read(int count, char** words) {
    for (int i = 1; i < count; ++i) {
      const std::string word = words[i];
      if (word == "--no-occt") {
        with_occt = false;
        continue;
      }
      if (i + 1 == count) fail("a value is missing after " + word);
      const std::string value = words[++i];
      if (word == "--folder")
        folder = value;
      else if (word == "--repeats")
        repeats = numbers_in(value).front();
      else if (word == "--threads")
        threads = numbers_in(value).front();
      else if (word == "--sizes")
        sizes = numbers_in(value);
      else
        fail("unknown word " + word);
    }
  }
  [[nodiscard]] bool is_occt_repeated(int repeat, int size) const {  // fewer where it takes long
    return with_occt && (repeat < 5 || size <= 64);
  }
};

template <class Outcome>  // with `seconds`
struct Measured {
  Outcome outcome;
  double peak_mib = 0;  // growth of the largest resident set over that of the process before the job
};

inline long peak_kib() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

// In a process of its own, so that the peak memory is this job's; a small one first, since starting up is no
// part of it.
template <class Job, class Input>
auto measure(const Job& job, const Input& small, const Input& input) {
  using Outcome = decltype(job(input));
  static_assert(std::is_trivially_copyable_v<Outcome>);
  int ends[2];
  if (::pipe(ends) != 0) fail("pipe");
  const pid_t child = ::fork();
  if (child == 0) {
    job(small);
    const long before = peak_kib();
    Measured<Outcome> measured{job(input), 0};
    measured.peak_mib = static_cast<double>(peak_kib() - before) / 1024;
    const bool sent = ::write(ends[1], &measured, sizeof measured) == sizeof measured;
    ::_exit(sent ? 0 : 1);
  }
  ::close(ends[1]);
  Measured<Outcome> measured;
  const bool got = ::read(ends[0], &measured, sizeof measured) == sizeof measured;
  ::close(ends[0]);
  int state = 0;
  ::waitpid(child, &state, 0);
  if (!got || state != 0) fail("a job of the benchmark failed");
  return measured;
}

inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

template <class Outcome>
Measured<Outcome> median(std::vector<Measured<Outcome>> all) {
  std::sort(all.begin(), all.end(),
            [](const auto& a, const auto& b) { return a.outcome.seconds < b.outcome.seconds; });
  return all[all.size() / 2];
}

// The median of the ratios of time of neighbouring runs: what else the machine does changes slowly against
// them.
template <class Outcome>
double median_ratio(const std::vector<Measured<Outcome>>& above,
                    const std::vector<Measured<Outcome>>& below) {
  std::vector<double> ratios;
  for (std::size_t r = 0; r < std::min(above.size(), below.size()); ++r)
    ratios.push_back(above[r].outcome.seconds / below[r].outcome.seconds);
  return median(std::move(ratios));
}

// One JSON object to standard output; `more` are members of it, each with a comma behind.
inline void print_rows(std::string_view benchmark, std::string_view more, int repeats,
                       const std::vector<std::string>& rows) {
  fmt::print("{{\"benchmark\": \"{}\", {}\"repeats\": {}, \"rows\": [\n{}\n]}}\n", benchmark, more, repeats,
             fmt::join(rows, ",\n"));
}

}  // namespace selvage::benchmarks
