#include "core/console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>

#include "core/diagnostics.h"
#include "core/words.h"

namespace selvage {

namespace {

bool wants_colors() {
  const char* const refused = std::getenv("NO_COLOR");
  const char* const terminal = std::getenv("TERM");
  return (refused == nullptr || *refused == '\0') && terminal != nullptr &&
         std::string_view(terminal) != "dumb" && ::isatty(STDERR_FILENO) != 0;
}

// The place of "error: " and its like in a line: at its beginning, or behind what it is about. The length is
// 0 where there is none.
struct Found {
  std::size_t at = std::string_view::npos, length = 0;
  Severity severity = Severity::error;
};

Found severity_of(std::string_view line) {
  Found found;
  for (const Severity severity : {Severity::error, Severity::warning, Severity::note}) {
    const std::string word = fmt::format("{}:", name_of(severity));
    std::size_t at = line.find(": " + word + " ");
    at = line.starts_with(word + " ") ? 0 : at == std::string_view::npos ? at : at + 2;
    if (at < found.at) found = {at, word.size(), severity};
  }
  return found;
}

}  // namespace

std::string colored(std::string_view messages) {
  constexpr std::array<int, 3> colors = {36, 35, 31};  // of ECMA-48: cyan, magenta, red; by Severity
  std::string out;
  while (!messages.empty()) {
    const std::size_t end = std::min(messages.find('\n'), messages.size());
    const std::string_view line = messages.substr(0, end);
    const Found found = severity_of(line);
    if (found.length == 0)
      out += line;
    else
      out += fmt::format("{}\033[1;{}m{}\033[0m{}", line.substr(0, found.at),
                         colors[static_cast<std::size_t>(found.severity)],
                         line.substr(found.at, found.length), line.substr(found.at + found.length));
    if (end < messages.size()) out += '\n';
    messages.remove_prefix(std::min(end + 1, messages.size()));
  }
  return out;
}

void write_messages(std::string_view messages) {
  const std::string text = wants_colors() ? colored(messages) : std::string(messages);
  std::fwrite(text.data(), 1, text.size(), stderr);
}

}  // namespace selvage
