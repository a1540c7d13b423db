#include "formats/txt/cursor.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "core/number_text.h"
#include "formats/txt/words.h"

namespace selvage::formats::txt {

namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t';
}

// The bytes of a blank at p: 1, those of a no-break or thin space as word processors put in, or 0.
std::size_t blank_at(const char* p, const char* end) {
  if (p == end) return 0;
  if (is_blank(*p)) return 1;
  if (static_cast<unsigned char>(*p) < 0x80) return 0;
  constexpr std::string_view wide[] = {"\xC2\xA0", "\xE2\x80\xAF", "\xE2\x80\x87", "\xE2\x80\x89",
                                       "\xE3\x80\x80"};
  const std::string_view rest(p, static_cast<std::size_t>(end - p));
  for (const std::string_view space : wide)
    if (rest.starts_with(space)) return space.size();
  return 0;
}

// The bytes of a double quote at p, straight or curly; 0: there is none. One that opens with a straight quote
// closes with one.
std::size_t quote_at(const char* p, const char* end) {
  if (p == end) return 0;
  if (*p == '"') return 1;
  if (static_cast<unsigned char>(*p) < 0x80) return 0;
  constexpr std::string_view curly[] = {"\xE2\x80\x9C", "\xE2\x80\x9D", "\xE2\x80\x9E", "\xC2\xAB",
                                        "\xC2\xBB"};
  const std::string_view rest(p, static_cast<std::size_t>(end - p));
  for (const std::string_view quote : curly)
    if (rest.starts_with(quote)) return quote.size();
  return 0;
}

// `//` begins a comment where a word would begin.
bool begins_comment(const char* p, const char* end) {
  return end - p > 1 && p[0] == '/' && p[1] == '/';
}

// Of what begins a comment elsewhere.
std::string_view comment_hint(std::string_view word) {
  for (const std::string_view sign : {";", "--", "/*", "%", "!", "'"})
    if (word.starts_with(sign)) return ": a comment begins with #";
  return {};
}

bool is_not_finite_word(std::string_view word) {
  if (!word.empty() && (word.front() == '+' || word.front() == '-')) word.remove_prefix(1);
  return same_word(word, "nan") || same_word(word, "inf") || same_word(word, "infinity");
}

// Does the whole word read as a number?
bool is_number(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
  double value = 0.0;
  const auto [stop, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
  return failure != std::errc::invalid_argument && stop == word.data() + word.size();
}

}  // namespace

std::string with_plain_blanks(std::string_view text) {
  std::string plain;
  const char* const end = text.data() + text.size();
  for (const char* p = text.data(); p != end;) {
    const std::size_t blank = blank_at(p, end);
    plain += blank > 0 ? ' ' : *p;
    p += std::max<std::size_t>(blank, 1);
  }
  return plain;
}

Cursor::Cursor(const Source& source, TextReport& report) : report_(report) {
  std::string_view bytes = source.bytes();
  begin_ = bytes.data();
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  at_ = line_begin_ = statement_ = token_ = bytes.data();
  end_ = at_ + bytes.size();
}

// --- statements
// -----------------------------------------------------------------------------------------------------

bool Cursor::ends_line(const char* p) const {
  return p == end_ || *p == '\n' || *p == '#' || (*p == '\r' && (p + 1 == end_ || p[1] == '\n'));
}

bool Cursor::ends_token(const char* p) const {
  return p == end_ || blank_at(p, end_) > 0 || ends_line(p);
}

Spot Cursor::spot_at(const char* p) const {
  return Spot{static_cast<std::size_t>(line_begin_ - begin_), line_, 1}.behind(
      static_cast<std::size_t>(p - line_begin_));
}

bool Cursor::next_statement() {
  go_on();
  bare_lengths_ = 0;
  if (is_stopped()) return false;
  if (reread_) {
    reread_ = false;
    return statement_ != end_;
  }
  for (;; fresh_ = false) {
    if (!fresh_) {
      if (at_ != end_ && *at_ != '\n') {
        skip_comment();
        const void* newline = at_ == end_ ? nullptr : std::memchr(at_, '\n', bytes_left());
        at_ = newline != nullptr ? static_cast<const char*>(newline) : end_;
      }
      if (at_ == end_) {
        statement_ = token_ = end_;
        return false;
      }
      line_begin_ = ++at_;
      ++line_;
    }
    skip_blanks();
    if (at_ == end_ || *at_ == '\n' || ends_line(at_) || begins_comment(at_, end_)) continue;
    if (is_stopped()) return false;
    fresh_ = false;
    statement_ = token_ = at_;
    return true;
  }
}

// A comment may hold anything but what shows that the file is no text at all.
void Cursor::skip_comment() {
  if (*at_ != '#' && !begins_comment(at_, end_)) return;
  const void* newline = std::memchr(at_, '\n', bytes_left());
  const char* const stop = newline != nullptr ? static_cast<const char*>(newline) : end_;
  const void* zero = std::memchr(at_, '\0', static_cast<std::size_t>(stop - at_));
  if (zero != nullptr) refuse_foreign({static_cast<const char*>(zero), 1});
  at_ = stop;
}

void Cursor::reread() {
  reread_ = true;
  at_ = token_ = statement_;
}

std::size_t Cursor::rows_ahead() const {
  std::size_t rows = 0;
  const char* p = at_;
  while (p != end_) {
    const void* newline = std::memchr(p, '\n', static_cast<std::size_t>(end_ - p));
    if (newline == nullptr) break;
    p = static_cast<const char*>(newline) + 1;
    while (p != end_ && is_blank(*p)) ++p;
    if (p == end_ || is_letter(*p)) break;
    ++rows;
  }
  return rows;
}

// --- tokens
// ---------------------------------------------------------------------------------------------------------

void Cursor::skip_blanks() {
  while (const std::size_t size = blank_at(at_, end_)) at_ += size;
}

bool Cursor::has_token() {
  skip_blanks();
  return !ends_line(at_) && !begins_comment(at_, end_);
}

Spot Cursor::here() {
  if (has_token()) return spot_at(at_);
  const char* behind = at_;
  while (behind != line_begin_ && is_blank(behind[-1])) --behind;
  return spot_at(behind);
}

std::string_view Cursor::word_at(const char* p) const {
  const char* stop = p;
  while (!ends_token(stop)) ++stop;
  return {p, static_cast<std::size_t>(stop - p)};
}

bool Cursor::next_is_letter() {
  return has_token() && is_letter(*at_);
}

std::string_view Cursor::peek_word() {
  return has_token() ? word_at(at_) : std::string_view{};
}

std::string_view Cursor::take_word() {
  const std::string_view word = peek_word();
  if (word.empty()) return word;
  token_ = at_;
  at_ += word.size();
  return word;
}

std::string_view Cursor::take_color_code() {
  if (has_token() || bytes_left() < 2 || *at_ != '#') return {};
  const char* stop = at_ + 1;
  while (stop != end_ && (is_letter(*stop) || (*stop >= '0' && *stop <= '9'))) ++stop;
  if (stop == at_ + 1 || !ends_token(stop)) return {};
  token_ = at_;
  at_ = stop;
  return {token_, static_cast<std::size_t>(stop - token_)};
}

std::string_view Cursor::take_rest() {
  if (!has_token()) return {};
  token_ = at_;
  while (!ends_line(at_)) ++at_;
  const char* last = at_;
  while (last != token_ && is_blank(last[-1])) --last;
  return {token_, static_cast<std::size_t>(last - token_)};
}

std::string_view Cursor::peek_rest() {
  if (!has_token()) return {};
  const char* stop = at_;
  while (!ends_line(stop) && !(begins_comment(stop, end_) && blank_at(stop - 1, stop) > 0)) ++stop;
  while (stop != at_ && is_blank(stop[-1])) --stop;
  return {at_, static_cast<std::size_t>(stop - at_)};
}

void Cursor::take_bytes(std::size_t size) {
  token_ = at_;
  at_ += size;
}

std::optional<std::string_view> Cursor::rest_of(std::string_view what) {
  if (failed_) return std::nullopt;
  if (!more()) return fail(here(), fmt::format("{} is missing", what));
  const std::string_view rest = peek_rest();
  token_ = at_;
  at_ += rest.size();
  if (refuse_foreign(rest)) return std::nullopt;
  return rest;
}

bool Cursor::refuse_foreign(std::string_view token) {
  const std::size_t good = text_prefix(token);
  if (good == token.size()) return false;
  const char* const bad = token.data() + good;
  if (*bad == '\r')
    report_.error(spot_at(bad), "a carriage return within a line: lines end with LF or CR LF");
  else if (static_cast<unsigned char>(*bad) >= 0x80)
    report_.error(spot_at(bad), "these bytes are not UTF-8 text; save the file as UTF-8");
  else
    report_.error(spot_at(bad), fmt::format("a control character (byte {}): this is not a text file",
                                            static_cast<int>(static_cast<unsigned char>(*bad))));
  stop();
  failed_ = true;
  return true;
}

std::optional<std::string_view> Cursor::quoted_name(std::string_view what, bool may_be_empty) {
  const char* const first = at_ + quote_at(at_, end_);
  const bool is_curly = *at_ != '"';
  const auto closes = [&](const char* p) { return is_curly ? quote_at(p, end_) > 0 : *p == '"'; };
  const char* close = first;
  while (close != end_ && !closes(close) && *close != '\n') ++close;
  const Spot open = spot_at(at_);
  at_ = close;
  if (close == end_ || *close == '\n')
    return fail(open, fmt::format("{}: the quote is not closed on this line", what));
  const std::string_view text(first, static_cast<std::size_t>(close - first));
  at_ += quote_at(at_, end_);
  if (refuse_foreign(text)) return std::nullopt;
  if (text.empty() && !may_be_empty) return fail(last(), fmt::format("{}: an empty name", what));
  if (ends_token(at_) || *at_ == ',') return text;
  return fail(spot_at(at_), fmt::format("{}: a blank is missing after the quote", what));
}

std::optional<std::string_view> Cursor::name(std::string_view what, bool may_be_empty) {
  if (failed_) return std::nullopt;
  if (!more()) return fail(here(), fmt::format("{} is missing", what));
  token_ = at_;
  if (quote_at(at_, end_) > 0) return quoted_name(what, may_be_empty);
  const std::string_view word = word_at(at_);
  const char* p = at_;
  while (p != word.data() + word.size() && (p == at_ ? starts_name(*p) : continues_name(*p))) ++p;
  const std::string_view text(at_, static_cast<std::size_t>(p - at_));
  if (!text.empty() && (ends_token(p) || *p == ',')) {
    at_ = p;
    return text;
  }
  at_ += word.size();
  if (refuse_foreign(word)) return std::nullopt;
  const bool is_name_with_sign = text.size() + 1 == word.size() && !text.empty();
  return fail(last(), fmt::format("{}: {} is not a name (letters, digits, '_', '.', '-', a letter first; "
                                  "anything else stands in double quotes){}",
                                  what, in_quotes(word),
                                  is_name_with_sign ? fmt::format(": write '{}'", text) : std::string()));
}

std::size_t Cursor::leading_count(bool with_blank) {
  if (!more()) return 1;
  std::size_t count = 0;
  auto [stop, failure] = std::from_chars(at_, end_, count);
  while (with_blank && stop != at_ && stop != end_ && (*stop == ' ' || *stop == '\t')) ++stop;
  if (stop == at_ || stop == end_ || (!starts_name(*stop) && *stop != '"')) return 1;
  token_ = at_;
  at_ = stop;
  return failure == std::errc{} ? count : 0;
}

bool Cursor::comma() {
  if (!more() || *at_ != ',') return false;
  ++at_;
  return true;
}

// --- numbers
// --------------------------------------------------------------------------------------------------------

// At the first character of a token. Moves only when the whole token is a finite number.
bool Cursor::parse_number(double& value) {
  const char* p = at_;
  if (*p == '+' && (++p == end_ || *p == '-')) return false;
  const auto [stop, failure] = std::from_chars(p, end_, value);
  if (!ends_token(stop)) return false;
  if (failure == std::errc::result_out_of_range) return parse_tiny_number(value);
  if (failure != std::errc{} || !std::isfinite(value)) return false;
  at_ = stop;
  return true;
}

// from_chars calls what rounds to zero out of range, too; only what is too large is an error of ours.
bool Cursor::parse_tiny_number(double& value) {
  const std::string_view word = word_at(at_);
  const std::string_view digits = word.front() == '+' ? word.substr(1) : word;
  long double wide = 0.0L;
  const auto [stop, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), wide);
  if (failure != std::errc{}) {  // beyond even long double: the exponent's sign tells which way
    const std::size_t exponent = digits.find_first_of("eE");
    if (exponent == digits.npos || digits.substr(exponent + 1, 1) != "-") return false;
    wide = digits.front() == '-' ? -0.0L : 0.0L;
  }
  if (std::abs(wide) >= 1.0L) return false;
  at_ += word.size();
  value = static_cast<double>(wide);
  return true;
}

// The token at hand is no number: says why, and leaves it behind.
std::nullopt_t Cursor::explain_number(std::string_view what) {
  token_ = at_;
  const std::string_view word = word_at(at_);
  at_ += word.size();
  if (refuse_foreign(word)) return std::nullopt;
  std::string pointed(word);
  const auto commas = std::count(word.begin(), word.end(), ',');
  std::replace(pointed.begin(), pointed.end(), ',', '.');
  std::string reason;
  const auto behind = word.size() - std::min(word.size(), word.rfind(',') + 1);
  if (commas == 1 && word.back() != ',' && is_number(pointed)) {
    reason = fmt::format("a decimal comma in {}: the decimal mark is the point, write {}", in_quotes(word),
                         pointed);
    if (behind == 3 && word.front() != '0') {
      std::erase(pointed, '.');
      reason += fmt::format(", or {} if thousands were meant", pointed);
    }
  } else if (commas == 1 && word.back() == ',' && is_number(word.substr(0, word.size() - 1)))
    reason = fmt::format("a comma behind the number: values are separated by blanks, write {}",
                         word.substr(0, word.size() - 1));
  else if (commas > 0)
    reason = fmt::format("commas in {}: values are separated by blanks, the decimal mark is the point",
                         in_quotes(word));
  else if (is_not_finite_word(word))
    reason = fmt::format("{} is not a finite number", in_quotes(word));
  else if (is_number(word))
    reason = fmt::format("{} is too large for a number in double precision", in_quotes(word));
  else
    reason = fmt::format("{} is not a number", in_quotes(word));
  return fail(last(), fmt::format("{}: {}", what, reason));
}

// An expression is a word, but for blanks within brackets.
std::string_view Cursor::expression_at(const char* p) const {
  int depth = 0;
  const char* stop = p;
  for (; !ends_line(stop) && (depth > 0 || !is_blank(*stop)); ++stop)
    depth += (*stop == '(') - (*stop == ')');
  while (stop != p && is_blank(stop[-1])) --stop;
  return {p, static_cast<std::size_t>(stop - p)};
}

std::optional<double> Cursor::other_number(std::string_view what, Measure measure) {
  const std::string_view text = expression_at(at_);
  if (text_prefix(text) != text.size()) return explain_number(what);
  const std::optional<Result<double>> value = scope_.value(text, measure);
  if (!value) return explain_number(what);
  token_ = at_;
  at_ += text.size();
  if (value->ok()) return **value;
  return fail(last(), fmt::format("{}: {}", what, value->error().text));
}

std::optional<double> Cursor::number(std::string_view what, Measure measure) {
  if (failed_) return std::nullopt;
  if (!more()) return fail(here(), fmt::format("{} is missing", what));
  token_ = at_;
  double value = 0.0;
  return parse_number(value) ? with_unit_behind(value, what, measure) : other_number(what, measure);
}

// `0.42 mm`: a unit behind a blank. Where bare numbers are in front of it, it may be meant for these, too.
std::optional<double> Cursor::with_unit_behind(double value, std::string_view what, Measure measure) {
  if (measure == Measure::plain || measure == Measure::any) return value;
  const Spot spot = last();
  const std::string_view word = peek_word();
  const NumberUnit* const unit = word.empty() ? nullptr : Scope::unit_of(word, measure);
  if (unit == nullptr) {
    bare_lengths_ += measure == Measure::length ? 1 : 0;
    return value;
  }
  take_word();
  const double size = scope_.size_of(*unit);
  if (bare_lengths_ > 0 && measure == Measure::length && size != 1.0)
    return fail(spot,
                fmt::format("{}: every number of this line needs its own unit right behind it, as in {}{}",
                            what, number_text(value), word));
  return size < 1.0 ? value / (1.0 / size) : value * size;
}

std::optional<int> Cursor::integer(std::string_view what, int least, int most) {
  const std::string_view word = peek_word();
  const std::optional<double> value = number(what);
  if (!value) return std::nullopt;
  if (*value != std::floor(*value) || (is_number(word) && word.find_first_of(".eE") != word.npos))
    return fail(last(), fmt::format("{}: {} is not a whole number", what, in_quotes(word)));
  if (*value >= least && *value <= most) return static_cast<int>(*value);
  std::string range = fmt::format("from {} to {}", least, most);
  if (most == std::numeric_limits<int>::max() && *value < least) range = fmt::format("{} or more", least);
  return fail(last(), fmt::format("{}: {} has to be {}", what, in_quotes(word), range));
}

int Cursor::row(double* values, int most, std::string_view what, Measure last_one,
                std::initializer_list<std::string_view> words) {
  for (int count = 0;; ++count) {
    if (!has_token()) return count;
    token_ = at_;
    const bool is_number = count < most && parse_number(values[count]);
    if (is_number) continue;
    const std::string_view next = word_at(at_);
    if (std::any_of(words.begin(), words.end(), [&](std::string_view word) { return same_word(next, word); }))
      return count;
    if (count == most) {
      report_.error(last(), fmt::format("{}: more than {} values", what, most));
      return -1;
    }
    const std::optional<double> value = other_number(what, count + 1 == most ? last_one : Measure::length);
    if (!value) return -1;
    values[count] = *value;
  }
}

bool Cursor::finish() {
  if (!more()) return !failed_;
  token_ = at_;
  const std::string_view word = word_at(at_);
  if (!refuse_foreign(word))
    report_.error(last(), fmt::format("nothing more is expected on this line, found {}{}", in_quotes(word),
                                      comment_hint(word)));
  return false;
}

}  // namespace selvage::formats::txt
