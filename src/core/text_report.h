// What is wrong with a text, gathered while it is read and handed over in the order of its lines.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"
#include "core/readable.h"
#include "core/source.h"

namespace selvage {

// A place in a text; line and column count from 1, columns in bytes. It holds no pointer: a spot that is not
// in the text is reported as the nearest one that is.
struct Spot {
  std::size_t offset = 0;  // in Source::bytes(), the end of them included
  int line = 1;
  int column = 1;

  [[nodiscard]] TextPlace place() const { return {line, column}; }
  // On the same line, `bytes` farther on.
  [[nodiscard]] Spot behind(std::size_t bytes) const {
    const auto room = static_cast<std::size_t>(std::numeric_limits<int>::max() - column);
    return {offset + bytes, line, column + static_cast<int>(std::min(bytes, room))};
  }
};

// The spot of a place in the text of `source`, whose lines end with LF; the text's end where there is no such
// place.
Spot spot_at(const Source& source, TextPlace place);

// The number of bytes at the beginning of `bytes` that are whole UTF-8 characters and no control characters
// but tab.
std::size_t text_prefix(std::string_view bytes);

// Foreign text made fit for a message: in single quotes, shortened() to 48 characters.
std::string in_quotes(std::string_view text);

// The known word that was meant; empty when none is near. For words of one letter no guess is made.
std::string_view near_word(std::string_view word, const std::vector<std::string_view>& known);
// "; did you mean 'WORD'?", or nothing.
std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& known);

class TextReport {
 public:
  static constexpr int most_errors = 20, most_warnings = 100;

  explicit TextReport(const Source& source) : source_(source) {}

  // Gives nothing: what a function returns that has no value then.
  std::nullopt_t error(const Spot& spot, std::string text, Kind kind = Kind::malformed);
  void warning(const Spot& spot, std::string text);
  void note(const Spot& spot, std::string text);  // for what is said once a file

  [[nodiscard]] int errors() const { return errors_; }
  [[nodiscard]] bool is_full() const { return errors_ >= most_errors; }
  // The yarn that messages name from here on; empty: none.
  void set_yarn(std::string_view name) { yarn_ = name; }

  void hand_over(Diagnostics& diagnostics);

 private:
  void add(Severity severity, Kind kind, const Spot& spot, std::string text);

  const Source& source_;
  std::string_view yarn_;
  std::vector<Message> messages_;
  int errors_ = 0, warnings_ = 0;
};

// The optional that read(source, report) gives, all of whose messages go to `diagnostics`; nothing where one
// is an error.
template <class Read>
auto reported(const Source& source, Diagnostics& diagnostics, const Read& read) {
  TextReport report(source);
  auto made = read(source, report);
  if (report.errors() > 0) made.reset();
  report.hand_over(diagnostics);
  return made;
}

}  // namespace selvage
