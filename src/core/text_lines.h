// A text line by line.
#pragma once

#include <algorithm>
#include <string_view>

#include "core/text_report.h"

namespace selvage {

// Lines end with LF or CR LF; the last one may have no end.
class TextLines {
 public:
  // The views that it gives point into `text`.
  explicit TextLines(std::string_view text) : text_(text), line_(text.substr(0, 0)), rest_(text) {}

  // Goes on to the next line, at first to the first; false: there is none, and the one before stays.
  bool next() {
    if (rest_.empty()) return false;
    begin_ = {text_.size() - rest_.size(), ++number_, 1};
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    line_ = rest_.substr(0, end);
    if (line_.ends_with('\r')) line_.remove_suffix(1);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    return true;
  }

  [[nodiscard]] std::string_view line() const { return line_; }  // without its end
  [[nodiscard]] int number() const { return number_; }           // from 1; 0 before the first
  // Of the line's byte `column`, which counts from 0; of its end where it is shorter.
  [[nodiscard]] Spot spot(std::size_t column = 0) const {
    return begin_.behind(std::min(column, line_.size()));
  }

 private:
  std::string_view text_, line_, rest_;
  Spot begin_;  // of the line
  int number_ = 0;
};

}  // namespace selvage
