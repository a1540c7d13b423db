#include "core/tally.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage {

namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// Without names in quotes, and perhaps numbers: "yarns '' and '' overlap, # deep". An apostrophe within a
// word is none.
std::string pattern_of(std::string_view text, bool has_numbers = false) {
  std::string pattern;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool opens = text[i] == '\'' && (i == 0 || text[i - 1] == ' ' || text[i - 1] == '(');
    const std::size_t close = opens ? text.find('\'', i + 1) : std::string_view::npos;
    if (close != std::string_view::npos) {
      pattern += "''";
      i = close;
    } else if (!has_numbers && is_digit(text[i])) {
      const std::size_t end = std::min(text.find_first_not_of("0123456789.e+-", i), text.size());
      pattern += '#';
      i = end - 1;
    } else if (has_numbers || text[i] != '-') {  // a minus
      pattern += text[i];
    }
  }
  return pattern;
}

}  // namespace

Tally::OfKind& Tally::kind_of(const Message& message) {
  std::string key = fmt::format("{} {}", name_of(message.severity), pattern_of(message.text));
  if (kinds_.size() >= most_kinds && !index_.contains(key)) key = name_of(message.severity);
  const auto [found, is_new] = index_.emplace(std::move(key), kinds_.size());
  if (is_new) kinds_.emplace_back();
  return kinds_[found->second];
}

bool Tally::take(const Message& message, double badness) {
  OfKind& kind = kind_of(message);
  if (++kind.count == 1 || badness > kind.badness) {
    kind.badness = badness;
    kind.worst = message;
  }
  if (kind.shown.size() < shown_of_a_kind) {
    // Defects are shown yarn by yarn, of other messages those that differ in more than their names. Where
    // there is no file yet, the place is not in the text.
    const bool is_defect = message.severity == Severity::error || badness > 0;
    std::string text = fmt::format("{}:{}: {}", message.place.line, message.place.column,
                                   is_defect ? to_string(message) : pattern_of(message.text, true));
    if (std::find(kind.shown.begin(), kind.shown.end(), text) == kind.shown.end()) {
      kind.shown.push_back(std::move(text));
      return true;
    }
    // What was said of all of them needs no number.
    if (!is_defect && message.text == kind.worst.text) return false;
  }
  ++kind.hidden;
  return false;
}

std::vector<Message> Tally::rest() const {
  std::vector<Message> all;
  for (const OfKind& kind : kinds_) {
    if (kind.hidden == 0) continue;
    Message message = kind.worst;
    message.excerpt.clear();
    message.text = kind.shown.size() == 1
                       ? fmt::format("x{}: {}", kind.count, kind.worst.text)
                       : fmt::format("x{}, of which {} are not shown; {}: {}", kind.count, kind.hidden,
                                     kind.badness > 0 ? "the worst" : "for example", kind.worst.text);
    all.push_back(std::move(message));
  }
  return all;
}

std::vector<Message> Tally::summary() const {
  std::vector<Message> all;
  for (const Severity severity : {Severity::error, Severity::warning, Severity::note})
    for (const OfKind& kind : kinds_) {
      if (kind.worst.severity != severity) continue;
      Message message = kind.worst;
      if (kind.count > 1)
        message.text = fmt::format("x{}, {}: {}", kind.count, kind.badness > 0 ? "the worst" : "for example",
                                   kind.worst.text);
      all.push_back(std::move(message));
    }
  return all;
}

}  // namespace selvage
