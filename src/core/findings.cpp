#include "core/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace selvage {

namespace {

Message made(Severity severity, std::string text, TextPlace place) {
  Message message = error(Kind::malformed, std::move(text));
  message.severity = severity;
  message.place = place;
  return message;
}

}  // namespace

void Findings::defect(std::string_view kind, std::string text, TextPlace place) {
  add(kind, made(Severity::error, std::move(text), place));
}
void Findings::warning(std::string_view kind, std::string text, TextPlace place) {
  add(kind, made(Severity::warning, std::move(text), place));
}
void Findings::note(std::string_view kind, std::string text, TextPlace place) {
  add(kind, made(Severity::note, std::move(text), place));
}

void Findings::add(std::string_view kind, Message message) {
  if (message.severity == Severity::error) ++defects_;
  if (message.severity == Severity::warning) ++warnings_;
  auto found = kinds_.find(kind);
  if (found == kinds_.end()) found = kinds_.emplace(std::string(kind), OfKind{}).first;
  OfKind& of_kind = found->second;
  of_kind.severity = std::max(of_kind.severity, message.severity);
  if (static_cast<int>(of_kind.shown.size()) < shown_of_a_kind)
    of_kind.shown.push_back(std::move(message));
  else
    ++of_kind.more;
}

std::vector<Message> Findings::messages() const {
  std::vector<Message> all;
  for (const auto& [kind, of_kind] : kinds_) {
    all.insert(all.end(), of_kind.shown.begin(), of_kind.shown.end());
    if (of_kind.more == 0) continue;
    all.push_back(made(of_kind.severity, fmt::format("and {} more {}", of_kind.more, kind),
                       of_kind.shown.back().place));
  }
  const auto line = [](const Message& message) {
    return message.place.line > 0 ? message.place.line : std::numeric_limits<int>::max();
  };
  std::stable_sort(all.begin(), all.end(),
                   [&](const Message& a, const Message& b) { return line(a) < line(b); });
  return all;
}

}  // namespace selvage
