#include "core/diagnostics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/readable.h"
#include "core/words.h"

namespace selvage {

std::string_view name_of(Severity severity) {
  constexpr std::array<std::string_view, 3> names = {"note", "warning", "error"};
  return names[static_cast<std::size_t>(severity)];
}

std::string_view name_of(Kind kind) {
  constexpr std::array<std::string_view, 8> names = {"malformed", "unsupported", "io",       "geometry",
                                                     "limit",     "usage",       "internal", "interrupted"};
  return names[static_cast<std::size_t>(kind)];
}

std::string to_string(const Message& message) {
  std::string out;
  if (!message.file.empty()) {
    out += readable(message.file);
    if (message.place.line > 0) out += fmt::format(":{}", message.place.line);
    if (message.place.line > 0 && message.place.column > 0) out += fmt::format(":{}", message.place.column);
    out += ": ";
  }
  out += fmt::format("{}: {}", name_of(message.severity), readable(message.text));
  const std::string quoted = fmt::format("'{}'", shortened(message.yarn));
  if (!message.yarn.empty() && message.text.find("'" + message.yarn + "'") == std::string::npos)
    out += fmt::format(" (yarn {})", quoted);
  if (message.at) {
    // What is rounding beside the other coordinates is shown as 0.
    const double rounding = 1e-9 * message.at->norm();
    const auto shown = [&](double c) { return std::abs(c) < rounding ? 0.0 : c; };
    out += fmt::format(" at ({:.6g}, {:.6g}, {:.6g})", shown(message.at->x()), shown(message.at->y()),
                       shown(message.at->z()));
  }
  if (!message.excerpt.empty()) {
    out += "\n  " + message.excerpt;
    if (message.caret > 0) {
      out += "\n  ";
      for (int i = 0; i + 1 < message.caret && i < static_cast<int>(message.excerpt.size()); ++i) {
        const char c = message.excerpt[static_cast<std::size_t>(i)];
        if (!is_continuation(c)) out += c == '\t' ? '\t' : ' ';  // a character: one column
      }
      out += '^';
    }
  }
  return out;
}

Message error(Kind kind, std::string text, About about) {
  Message message{std::move(about)};
  message.kind = kind;
  message.text = std::move(text);
  return message;
}

Message warning(Kind kind, std::string text, About about) {
  Message message = error(kind, std::move(text), std::move(about));
  message.severity = Severity::warning;
  return message;
}

Message note(Kind kind, std::string text) {
  Message message = error(kind, std::move(text));
  message.severity = Severity::note;
  return message;
}

Message Message::placed(TextPlace where, std::string_view in_file) const {
  Message message = *this;
  if (place.line == 0) message.place = where;
  if (file.empty()) message.file = in_file;
  return message;
}

Message Message::of_yarn(std::string_view name, TextPlace where) const {
  Message message = placed(where);
  if (yarn.empty()) message.yarn = name;
  return message;
}

Message Message::at_point(const Vec3& point) const {
  Message message = *this;
  if (!at) message.at = point;
  return message;
}

namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  // Optimal string alignment: a swap of two neighbours counts as one step.
  std::vector<std::size_t> before(b.size() + 1), row(b.size() + 1), next(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    next[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      next[j] = std::min({row[j] + 1, next[j - 1] + 1, row[j - 1] + (same ? 0U : 1U)});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]))
        next[j] = std::min(next[j], before[j - 2] + 1);
    }
    before.swap(row);
    row.swap(next);
  }
  return row[b.size()];
}

}  // namespace

std::string_view nearest_word(std::string_view word, const std::vector<std::string_view>& known) {
  if (word.size() > 64) return {};
  std::string_view best;
  std::size_t best_distance = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (std::string_view candidate : known) {
    // Each letter too many is a step.
    if (word.size() + best_distance <= candidate.size() || candidate.size() + best_distance <= word.size())
      continue;
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

void Diagnostics::add(Message message) {
  if (message.severity == Severity::error && ++errors_ > max_errors_) return;
  messages_.push_back(std::move(message));
}

const Message* Diagnostics::first_error() const {
  const auto found = std::find_if(messages_.begin(), messages_.end(),
                                  [](const Message& m) { return m.severity == Severity::error; });
  return found == messages_.end() ? nullptr : &*found;
}

}  // namespace selvage
