// The tokens of a Part 21 text (ISO 10303-21) with their places.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "core/text_report.h"

namespace selvage::formats::step {

// What is wrong with a text, thrown by those who read it and caught where they are called.
struct Failure {
  Spot spot;
  std::string text;
};

enum class Token {
  end,
  word,
  reference,
  string,
  number,
  omitted,
  derived,
  enumeration,
  other,
  open,
  close,
  comma,
  semicolon,
  equals
};

// Exceptions of next(): Failure.
class Lexer {
 public:
  // Of the text from `start` on.
  explicit Lexer(std::string_view text, const Spot& start = {})
      : begin_(text.data()),
        at_(begin_ + std::min(start.offset, text.size())),
        end_(begin_ + text.size()),
        line_start_(start) {}

  [[nodiscard]] Token token() const { return token_; }
  [[nodiscard]] std::string_view text() const { return text_; }
  [[nodiscard]] int reference() const { return reference_; }
  [[nodiscard]] const Spot& spot() const { return spot_; }
  // Of a string: an apostrophe inside it stands alone, where two should.
  [[nodiscard]] bool has_bare_apostrophe() const { return has_bare_apostrophe_; }

  void next();
  // Up to the statement's end, whatever stands there.
  void skip_statement();

 private:
  [[nodiscard]] Spot here() const {
    return line_start_.behind(static_cast<std::size_t>(at_ - begin_) - line_start_.offset);
  }
  void new_line();
  void skip_blanks();
  void skip_comment();
  Token take();
  void check_size(std::string_view number) const;
  Token take_reference();
  Token take_string();
  Token take_enclosed(char last, std::string_view kind);

  const char* begin_;
  const char* at_;
  const char* end_;
  Spot line_start_;  // or where it began, on its first line
  Token token_ = Token::end;
  std::string_view text_;
  int reference_ = 0;
  bool has_bare_apostrophe_ = false;
  Spot spot_;
};

}  // namespace selvage::formats::step
