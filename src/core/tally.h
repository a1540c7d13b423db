// Many messages that say the same of many things: the first few are shown, and at the end how many there were
// and the worst of them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/diagnostics.h"

namespace selvage {

class Tally {
 public:
  static constexpr std::size_t shown_of_a_kind = 20, most_kinds = 100;

  // Counts a message; true when it is to be shown: few of its kind were, and none that reads the same.
  // Messages are of one kind when they differ in names in quotes, in numbers and in places only; warnings and
  // notes read the same when they differ in names only. `badness` says which one is the worst, the larger the
  // worse (the depth of an overlap); 0: they cannot be compared.
  bool take(const Message& message, double badness = 0);

  // Of each kind that was not shown whole, one message: "x94, of which 74 are not shown; the worst: ...".
  // What is kept does not grow with the number of messages: beyond `most_kinds` kinds, the others of a
  // severity are one.
  [[nodiscard]] std::vector<Message> rest() const;
  // Of every kind one message, its worst: "x94, the worst: ..."; errors first, then warnings, then notes.
  [[nodiscard]] std::vector<Message> summary() const;

 private:
  struct OfKind {
    std::vector<std::string> shown;
    std::size_t count = 0, hidden = 0;
    double badness = 0;
    Message worst;
  };
  OfKind& kind_of(const Message& message);

  std::map<std::string, std::size_t> index_;
  std::vector<OfKind> kinds_;
};

}  // namespace selvage
