#include "formats/step/lexer.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace selvage::formats::step {

namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_name(char c) {
  return is_digit(c) || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_' || c == '-' || c == '!';
}

template <class Belongs>
const char* skip_while(const char* at, const char* end, Belongs belongs) {
  while (at != end && belongs(*at)) ++at;
  return at;
}

}  // namespace

void Lexer::next() {
  skip_blanks();
  spot_ = here();
  const char* const from = at_;
  token_ = at_ == end_ ? Token::end : take();
  text_ = {from, static_cast<std::size_t>(at_ - from)};
}

// Up to the statement's end, whatever stands there.
void Lexer::skip_statement() {
  while (token_ != Token::semicolon && token_ != Token::end) next();
}

void Lexer::new_line() {
  line_start_ = {static_cast<std::size_t>(at_ - begin_) + 1, line_start_.line + 1, 1};
}

void Lexer::skip_blanks() {
  for (; at_ != end_; ++at_) {
    if (*at_ == '\n') {
      new_line();
    } else if (*at_ == '/' && end_ - at_ > 1 && at_[1] == '*') {
      skip_comment();
    } else if (*at_ != ' ' && *at_ != '\t' && *at_ != '\r' && *at_ != '\f' && *at_ != '\0') {
      return;
    }
  }
}

// Stops at its last character.
void Lexer::skip_comment() {
  const Spot start = here();
  for (at_ += 2; end_ - at_ > 1; ++at_) {
    if (*at_ == '*' && at_[1] == '/') {
      ++at_;
      return;
    }
    if (*at_ == '\n') new_line();
  }
  throw Failure{start, "this comment has no end"};
}

Token Lexer::take() {
  const char c = *at_++;
  switch (c) {
    case '(':
      return Token::open;
    case ')':
      return Token::close;
    case ',':
      return Token::comma;
    case ';':
      return Token::semicolon;
    case '=':
      return Token::equals;
    case '$':
      return Token::omitted;
    case '*':
      return Token::derived;
    case '#':
      return take_reference();
    case '\'':
      return take_string();
    case '"':
      return take_enclosed('"', "binary value");
    case '<':
      return take_enclosed('>', "resource");
    case '.':
      at_ = skip_while(at_, end_, [](char part) { return is_name(part); });
      if (at_ == end_ || *at_ != '.') throw Failure{spot_, "this enumeration value has no end"};
      ++at_;
      return Token::enumeration;
    default:
      break;
  }
  if (is_digit(c) || c == '-' || c == '+') {
    at_ = skip_while(at_, end_, [](char part) {
      return is_digit(part) || part == '.' || part == 'E' || part == 'e' || part == '+' || part == '-';
    });
    const char* const from = begin_ + spot_.offset;
    check_size({from, static_cast<std::size_t>(at_ - from)});
    return Token::number;
  }
  if (!is_name(c)) throw Failure{spot_, fmt::format("{} is no part of a STEP file", in_quotes({&c, 1}))};
  at_ = skip_while(at_, end_, is_name);
  return Token::word;
}

// OpenCASCADE does not stop at an infinite knot.
void Lexer::check_size(std::string_view number) const {
  const std::size_t exponent = number.find_first_of("eE");
  if (exponent == std::string_view::npos && number.size() < 300) return;
  if (exponent != std::string_view::npos && number.substr(exponent + 1).starts_with('-')) return;
  std::string plain(number);
  if (exponent != std::string_view::npos) std::erase(plain, '+');
  double value = 0;
  const auto [last, failed] = std::from_chars(plain.data(), plain.data() + plain.size(), value);
  if (failed == std::errc::result_out_of_range)
    throw Failure{spot_, "a number that is larger than any number may be"};
}

Token Lexer::take_reference() {
  const char* const from = at_;
  at_ = skip_while(at_, end_, is_digit);
  const auto [last, failed] = std::from_chars(from, at_, reference_);
  if (last != at_ || failed != std::errc{} || from == at_ || reference_ <= 0)
    throw Failure{spot_, "'#' is not followed by a number from 1 to 2147483647"};
  return Token::reference;
}

// An apostrophe that should be doubled ends no string where a letter follows it: what may follow does not
// begin with one. But where another string may begin before the end, it may be a comma that is missing.
Token Lexer::take_string() {
  has_bare_apostrophe_ = false;
  const auto is_inside = [](char c) {
    return is_name(c) || c == '\\' || static_cast<unsigned char>(c) >= 0x80;
  };
  char before = 0;  // but for blanks
  for (; at_ != end_; ++at_) {
    if (*at_ == '\n') new_line();
    if (*at_ != '\'') {
      if (*at_ != ' ' && *at_ != '\n' && *at_ != '\r') before = *at_;
      continue;
    }
    if (has_bare_apostrophe_ && before == ',')
      throw Failure{spot_, "this string has no clear end: an apostrophe inside it is written twice"};
    ++at_;
    if (at_ == end_ || (*at_ != '\'' && !is_inside(*at_))) return Token::string;
    has_bare_apostrophe_ = has_bare_apostrophe_ || *at_ != '\'';
    before = *at_;
  }
  throw Failure{spot_, "this string has no end"};
}

Token Lexer::take_enclosed(char last, std::string_view kind) {
  at_ = skip_while(at_, end_, [last](char part) { return part != last && part != '\n'; });
  if (at_ == end_ || *at_ != last) throw Failure{spot_, fmt::format("this {} has no end", kind)};
  ++at_;
  return Token::other;
}

}  // namespace selvage::formats::step
