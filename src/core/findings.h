// What a check found: of each kind of finding the first few as they are, of the others their number.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"

namespace selvage {

class Findings {
 public:
  static constexpr int shown_of_a_kind = 20;

  // A defect, a warning with its remedy, or what is worth knowing only to who asks (-v). `kind`: a few words
  // that name it in the plural, for the count of the ones that are not shown ("lines of a wrong length").
  void defect(std::string_view kind, std::string text, TextPlace place = {});
  void warning(std::string_view kind, std::string text, TextPlace place = {});
  void note(std::string_view kind, std::string text, TextPlace place = {});
  void add(std::string_view kind, Message message);

  [[nodiscard]] bool is_sound() const { return defects_ == 0; }
  // All of them, whether shown or only counted.
  [[nodiscard]] int defects() const { return defects_; }
  [[nodiscard]] int warnings() const { return warnings_; }
  // In the order of their lines (those without a line last), each kind's count behind its last one.
  [[nodiscard]] std::vector<Message> messages() const;

 private:
  struct OfKind {
    Severity severity = Severity::error;
    std::vector<Message> shown;
    int more = 0;
  };
  std::map<std::string, OfKind, std::less<>> kinds_;
  int defects_ = 0, warnings_ = 0;
};

}  // namespace selvage
