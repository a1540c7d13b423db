// How far a batch has come, on standard error: a bar that is redrawn on a terminal, a plain line every ten
// seconds elsewhere (so that a log stays readable), a JSON object a line for a program that asked for it,
// nothing when it is not wanted.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>

namespace selvage {

enum class ProgressForm { none, shown, json };

class ProgressDisplay {
 public:
  ProgressDisplay(ProgressForm form, std::size_t total);

  // `detail`: what is being done right now, e.g. "plain.txt: meshing 3 of 4"; may be empty.
  void set(std::size_t done, std::size_t failed, std::string detail);
  // Draws when it is time to; returns the seconds until the next drawing is due.
  double tick();
  // Takes the bar away so that other lines can be written; the next tick() draws it again.
  void clear();
  // The same at the end: a program that reads learns that it is reached.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] double seconds() const;
  [[nodiscard]] std::optional<double> seconds_left() const;
  [[nodiscard]] std::string line() const;
  [[nodiscard]] std::string object() const;

  ProgressForm form_;
  bool on_terminal_;
  std::size_t total_;
  std::size_t done_ = 0, failed_ = 0;
  std::string detail_;
  bool drawn_ = false;
  Clock::time_point start_, next_;
};

}  // namespace selvage
