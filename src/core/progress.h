// How far a batch has come, on standard error: a bar that is redrawn on a terminal, a plain line every ten
// seconds elsewhere (so that a log stays readable), nothing when it is not wanted.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace selvage {

class ProgressDisplay {
 public:
  ProgressDisplay(bool wanted, std::size_t total);

  // `detail`: what is being done right now, e.g. "plain.txt: meshing 3 of 4"; may be empty.
  void set(std::size_t done, std::size_t failed, std::string detail);
  // Draws when it is time to; returns the seconds until the next drawing is due.
  double tick();
  // Takes the bar away so that other lines can be written; the next tick() draws it again.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] std::string line() const;

  bool wanted_;
  bool on_terminal_;
  std::size_t total_;
  std::size_t done_ = 0, failed_ = 0;
  std::string detail_;
  bool drawn_ = false;
  Clock::time_point start_, next_;
};

}  // namespace selvage
