#include "core/findings.h"

#include <algorithm>
#include <limits>

namespace selvage {

void Findings::defect(std::string text, TextPlace place, double badness) {
  add(error(Kind::malformed, std::move(text), {.place = place}), badness);
}

void Findings::warning(std::string text, TextPlace place, double badness) {
  add(selvage::warning(Kind::malformed, std::move(text), {.place = place}), badness);
}

void Findings::add(Message message, double badness) {
  if (message.severity == Severity::error) ++defects_;
  if (message.severity == Severity::warning) ++warnings_;
  if (tally_.take(message, badness) || keeps_all_) shown_.push_back(std::move(message));
}

std::vector<Message> Findings::messages() const {
  std::vector<Message> all = shown_;
  const auto line = [](const Message& message) {
    return message.place.line > 0 ? message.place.line : std::numeric_limits<int>::max();
  };
  std::stable_sort(all.begin(), all.end(),
                   [&](const Message& a, const Message& b) { return line(a) < line(b); });
  if (keeps_all_) return all;
  const std::vector<Message> rest = tally_.rest();
  all.insert(all.end(), rest.begin(), rest.end());
  return all;
}

}  // namespace selvage
