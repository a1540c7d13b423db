// The lexical rules: lines, words, names and numbers, one pass over the bytes of a Source. Nothing is copied
// and nothing is allocated but for messages.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "core/source.h"
#include "core/text_report.h"
#include "formats/txt/scope.h"

namespace selvage::formats::txt {

// The same with no-break and thin spaces as blanks.
std::string with_plain_blanks(std::string_view text);

class Cursor {
 public:
  // `bytes` of the source, without a byte-order mark.
  Cursor(const Source& source, TextReport& report);

  // --- statements
  // ------------------------------------------------------------------------------------------------- Goes to
  // the first token of the next line that has one. False at the end of the text, and as soon as the report is
  // full or stop() was called.
  bool next_statement();
  // The next call of next_statement() comes back to this statement.
  void reread();
  // Nothing more is read.
  void stop() { stopped_ = true; }
  [[nodiscard]] bool is_stopped() const { return stopped_ || report_.is_full(); }
  // Where the statement begins; after the last one: the end of the text.
  [[nodiscard]] Spot statement() const { return spot_at(statement_); }
  // The statement's first character, which is there.
  [[nodiscard]] char first_character() const { return *statement_; }
  [[nodiscard]] std::string_view statement_word() const { return word_at(statement_); }
  // An upper bound of how many statements follow this one before the next that begins with a letter.
  [[nodiscard]] std::size_t rows_ahead() const;
  [[nodiscard]] std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - at_); }

  // --- tokens of the statement
  // ------------------------------------------------------------------------------------ Is there another
  // token on this line? Not behind a value that is wrong.
  bool more() { return !failed_ && has_token(); }
  // The next token's spot; at the end of the line just behind the last token.
  Spot here();
  // The token taken last.
  [[nodiscard]] std::string_view token() const { return {token_, static_cast<std::size_t>(at_ - token_)}; }
  // Its spot.
  [[nodiscard]] Spot last() const { return spot_at(token_); }

  // Does the next token begin with this character, or with a letter?
  bool next_is(char c) { return has_token() && *at_ == c; }
  bool next_is_letter();

  // The next word, up to a blank; empty at the end of the line. Taking leaves it behind, peeking does not.
  std::string_view peek_word();
  std::string_view take_word();
  // `#RRGGBB`, `#RGB`, or what may be meant as one, which elsewhere would be a comment; empty where the next
  // token is none.
  std::string_view take_color_code();
  // The text up to a comment or the end of the line, without blanks round it.
  std::string_view take_rest();
  // The same of a value, which has to be there: reports what is missing, and what is no text.
  std::optional<std::string_view> rest_of(std::string_view what);
  // The same, without taking it.
  [[nodiscard]] std::string_view peek_rest();
  // Leaves that many bytes behind, as one token.
  void take_bytes(std::size_t size);

  // The following report what is wrong, calling the value `what`, and give nothing then, nor for what follows
  // it in the statement: that is not looked at. A name, or text in quotes; `may_be_empty`: "" is allowed.
  std::optional<std::string_view> name(std::string_view what, bool may_be_empty = false);
  // The 4 of `4a`, a name so many times; 1 where a name stands alone, 0 where there are too many.
  // `with_blank`: of `4 a`, too.
  std::size_t leading_count(bool with_blank = false);
  // The comma of a list of names, with blanks round it, if it comes next.
  bool comma();
  std::optional<double> number(std::string_view what, Measure measure = Measure::plain);
  std::optional<int> integer(std::string_view what, int least, int most);
  // The numbers up to the end of the line, or up to one of `words` where they may follow them, at most `most`
  // of them; returns how many. An error gives -1. `last_one`: what the most-th one measures; the others are
  // lengths.
  int row(double* values, int most, std::string_view what, Measure last_one = Measure::length,
          std::initializer_list<std::string_view> words = {});
  // Reports what is left on the line. True when there is nothing, and no value was wrong.
  bool finish();
  // A value was wrong: no further one of the statement is looked at.
  [[nodiscard]] bool has_failed() const { return failed_; }
  // Further ones are.
  void go_on() { failed_ = false; }

  // Units and params that numbers may name.
  [[nodiscard]] Scope& scope() { return scope_; }
  [[nodiscard]] const Scope& scope() const { return scope_; }

 protected:
  std::nullopt_t fail(const Spot& spot, std::string text) {
    failed_ = true;
    return report_.error(spot, std::move(text));
  }

 private:
  [[nodiscard]] bool ends_token(const char* p) const;
  [[nodiscard]] bool ends_line(const char* p) const;
  [[nodiscard]] Spot spot_at(const char* p) const;
  [[nodiscard]] std::string_view word_at(const char* p) const;
  bool has_token();
  void skip_blanks();
  bool parse_number(double& value);
  bool parse_tiny_number(double& value);
  [[nodiscard]] std::string_view expression_at(const char* p) const;
  // What is no bare number: with a unit, or an expression; else says what is wrong with it.
  std::optional<double> other_number(std::string_view what, Measure measure);
  std::optional<double> with_unit_behind(double value, std::string_view what, Measure measure);
  std::nullopt_t explain_number(std::string_view what);
  std::optional<std::string_view> quoted_name(std::string_view what, bool may_be_empty);
  void skip_comment();
  // Reports bytes that are no text and stops; false when all of `token` is text.
  bool refuse_foreign(std::string_view token);

  TextReport& report_;
  Scope scope_;
  const char* begin_;  // of all bytes
  const char* at_;
  const char* end_;
  const char* line_begin_;
  const char* statement_;
  const char* token_;
  int line_ = 1;
  bool fresh_ = true;  // the first line has not been looked at
  bool reread_ = false;
  bool stopped_ = false;
  int bare_lengths_ = 0;  // numbers of the statement that measure lengths and have no unit
  bool failed_ = false;   // a value of the statement
};

}  // namespace selvage::formats::txt
