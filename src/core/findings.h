// What a check found, and how much of it.
#pragma once

#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "core/tally.h"

namespace selvage {

class Findings {
 public:
  // `keeps_all`: messages() has every one, however many there are.
  explicit Findings(bool keeps_all = false) : keeps_all_(keeps_all) {}

  // A defect, a warning with its remedy, or what is worth knowing only to who asks (-v). `badness`: as in
  // core/tally.h.
  void defect(std::string text, TextPlace place = {}, double badness = 0);
  void warning(std::string text, TextPlace place = {}, double badness = 0);
  void add(Message message, double badness = 0);

  [[nodiscard]] bool is_sound() const { return defects_ == 0; }
  // All of them, whether shown or only counted.
  [[nodiscard]] int defects() const { return defects_; }
  [[nodiscard]] int warnings() const { return warnings_; }
  // In the order of their lines (those without a line last), then of many alike what is not shown (Tally).
  [[nodiscard]] std::vector<Message> messages() const;
  // One a kind, with the worst and how many there are (Tally::summary).
  [[nodiscard]] std::vector<Message> summary() const { return tally_.summary(); }

 private:
  bool keeps_all_;
  std::vector<Message> shown_;
  Tally tally_;
  int defects_ = 0, warnings_ = 0;
};

}  // namespace selvage
