// What a check found, and how much of it.
#pragma once

#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "core/tally.h"

namespace selvage {

class Findings {
 public:
  // A defect, a warning with its remedy, or what is worth knowing only to who asks (-v).
  void defect(std::string text, TextPlace place = {});
  void warning(std::string text, TextPlace place = {});
  void add(Message message);

  [[nodiscard]] bool is_sound() const { return defects_ == 0; }
  // All of them, whether shown or only counted.
  [[nodiscard]] int defects() const { return defects_; }
  [[nodiscard]] int warnings() const { return warnings_; }
  // In the order of their lines (those without a line last), then of many alike what is not shown (Tally).
  [[nodiscard]] std::vector<Message> messages() const;

 private:
  std::vector<Message> shown_;
  Tally tally_;
  int defects_ = 0, warnings_ = 0;
};

}  // namespace selvage
