#include "formats/step/stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "core/pointed_number.h"
#include "formats/step/character.h"

namespace selvage::formats::step {

namespace {

constexpr std::size_t block_size = 1U << 20;
// Leaves room for the brackets that may follow the last token.
constexpr std::size_t line_length = 72;

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_word(char c) {
  return is_digit(c) || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_' || c == '#';
}
// Integers, and reals as %a writes them.
bool is_number(char c) {
  return is_digit(c) || (c >= 'a' && c <= 'f') || c == '.' || c == '+' || c == '-' || c == 'x' || c == 'p';
}

template <class Belongs>
std::size_t length_while(std::string_view text, Belongs belongs) {
  std::size_t n = 0;
  while (n < text.size() && belongs(text[n])) ++n;
  return n;
}

}  // namespace

StepStream::StepStream(OutputFile& output) : output_(output), raw_(block_size, '\0') {
  out_.reserve(block_size);
  setp(raw_.data(), raw_.data() + raw_.size());
}

Status StepStream::close() {
  drain(true);
  return status_;
}

// OpenCASCADE ends each line with a flush; the block is written when it is full.
int StepStream::sync() {
  return status_.ok() ? 0 : -1;
}

int StepStream::overflow(int c) {
  drain(false);
  if (pptr() == epptr()) {  // one line that fills the whole block
    const auto used = static_cast<std::size_t>(pptr() - pbase());
    raw_.resize(2 * raw_.size());
    setp(raw_.data(), raw_.data() + raw_.size());
    pbump(static_cast<int>(used));
  }
  if (!status_.ok()) return traits_type::eof();
  if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
  return traits_type::not_eof(c);
}

void StepStream::drain(bool all) {
  const std::string_view text(pbase(), static_cast<std::size_t>(pptr() - pbase()));
  const std::size_t lines = all ? text.size() : text.rfind('\n') + 1;  // npos + 1 is 0: no complete line
  out_.clear();
  convert(text.substr(0, lines));
  if (status_.ok() && !out_.empty()) status_ = output_.write(out_);
  const std::size_t rest = text.size() - lines;
  std::char_traits<char>::move(raw_.data(), text.data() + lines, rest);
  setp(raw_.data(), raw_.data() + raw_.size());
  pbump(static_cast<int>(rest));
}

void StepStream::convert(std::string_view text) {
  while (!text.empty()) {
    const char c = text.front();
    std::size_t length = 1;
    if (in_string_) {
      length = std::min(text.find('\''), text.size());
      convert_string(text.substr(0, length));
      if (length < text.size()) {
        put_encoded();
        put("'");
        in_string_ = false;
        ++length;
      }
    } else if (c == '\n') {
      if (last_ == ';') put("\n");
      length += length_while(text.substr(1), [](char next) { return next == ' '; });
    } else if (c == '\'') {
      // A string is not broken: the line is filled up before it.
      if (column_ + text.substr(1).find('\'') > line_length && last_ != '\'') put("\n");
      put("'");
      in_string_ = true;
    } else if (is_digit(c) || c == '-') {
      length = length_while(text, is_number);
      put_number(text.substr(0, length));
    } else {
      if (is_word(c)) length = length_while(text, is_word);
      if (c == '.') length = std::max<std::size_t>(text.find('.', 1) + 1, 1);  // .T.
      put(text.substr(0, length));
    }
    text.remove_prefix(length);
  }
}

// Inside a string a line's end is OpenCASCADE's folding, not content. It doubles a backslash, as the standard
// has it, but its reader takes what follows two for a code all the same (\\X2\\0041): a backslash is written
// as a code itself, which every reader understands.
void StepStream::convert_string(std::string_view piece) {
  for (const char c : piece) {
    if (c == '\n') continue;
    if (c == '\\' && !after_backslash_) {
      after_backslash_ = true;
      continue;
    }
    if (after_backslash_ && c != '\\') {  // a code of OpenCASCADE's own
      put_encoded();
      put("\\");
    }
    const bool is_doubled = after_backslash_ && c == '\\';
    after_backslash_ = false;
    if (is_doubled || static_cast<unsigned char>(c) >= 0x80) {
      encoded_ += c;
      continue;
    }
    put_encoded();
    put({&c, 1});
  }
}

void StepStream::put_encoded() {
  std::string_view rest = encoded_;
  while (!rest.empty()) {
    const char32_t code = take_code(rest);
    put(code < 0x10000 ? fmt::format("\\X2\\{:04X}\\X0\\", static_cast<unsigned>(code))
                       : fmt::format("\\X4\\{:08X}\\X0\\", static_cast<unsigned>(code)));
  }
  encoded_.clear();
}

// A real stands here as printf's %a writes it, -0x1.8p+1; all else is an integer.
void StepStream::put_number(std::string_view number) {
  const std::size_t sign = number.front() == '-' ? 1 : 0;
  if (!number.substr(sign).starts_with("0x")) return put(number);
  double value = 0.0;
  std::from_chars(number.data() + sign + 2, number.data() + number.size(), value, std::chars_format::hex);
  char real[max_number_length];
  put({real, static_cast<std::size_t>(write_pointed(real, sign == 1 ? -value : value) - real)});
}

// Lines are broken after a comma, a space or an opening bracket, never inside a string.
void StepStream::put(std::string_view token) {
  if (!in_string_ && column_ + token.size() > line_length && (last_ == ',' || last_ == '(' || last_ == ' ')) {
    out_ += '\n';
    column_ = 0;
  }
  out_ += token;
  last_ = token.back();
  column_ = last_ == '\n' ? 0 : column_ + token.size();
}

}  // namespace selvage::formats::step
