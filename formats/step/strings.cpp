#include "formats/step/strings.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>

#include "core/text_report.h"

namespace selvage::formats::step {

namespace {

void append_utf8(std::string& text, char32_t code) {
  const auto put = [&](char32_t byte) { text += static_cast<char>(byte); };
  if (code < 0x20 || code == 0x7F) return put(U'_');
  if (code < 0x80) return put(code);
  if (code < 0x800) {
    put(0xC0 | code >> 6U);
  } else {
    if (code < 0x10000) {
      put(0xE0 | code >> 12U);
    } else {
      put(0xF0 | code >> 18U);
      put(0x80 | (code >> 12U & 0x3FU));
    }
    put(0x80 | (code >> 6U & 0x3FU));
  }
  put(0x80 | (code & 0x3FU));
}

// A hexadecimal number of `digits` digits off the front; nothing where there is none.
std::optional<char32_t> take_hex(std::string_view& text, std::size_t digits) {
  std::uint32_t code = 0;
  if (text.size() < digits) return std::nullopt;
  const auto [last, failed] = std::from_chars(text.data(), text.data() + digits, code, 16);
  if (failed != std::errc{} || last != text.data() + digits) return std::nullopt;
  text.remove_prefix(digits);
  return code;
}

// \X2\ and \X4\: code after code until \X0\. UTF-16 pairs, which some write, are one character.
void take_codes(std::string_view& text, std::size_t digits, std::string& result) {
  char32_t high = 0;
  while (const std::optional<char32_t> code = take_hex(text, digits)) {
    if (*code >= 0xD800 && *code < 0xDC00) {
      high = *code;
    } else if (*code >= 0xDC00 && *code < 0xE000) {
      if (high != 0) append_utf8(result, 0x10000 + ((high - 0xD800) << 10U) + (*code - 0xDC00));
      high = 0;
    } else if (*code <= 0x10FFFF) {
      append_utf8(result, *code);
    }
  }
  if (text.starts_with("\\X0\\")) text.remove_prefix(4);
}

}  // namespace

std::string decoded(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const char c = text.front();
    if (text.starts_with("''") || text.starts_with("\\\\")) {
      result += c;
      text.remove_prefix(2);
    } else if (text.starts_with("\\X2\\") || text.starts_with("\\X4\\")) {
      const std::size_t digits = text[2] == '2' ? 4 : 8;
      text.remove_prefix(4);
      take_codes(text, digits, result);
    } else if (text.starts_with("\\X\\")) {
      text.remove_prefix(3);
      if (const std::optional<char32_t> code = take_hex(text, 2)) append_utf8(result, *code);
    } else if (text.starts_with("\\S\\") && text.size() > 3) {
      append_utf8(result, static_cast<unsigned char>(text[3]) | 0x80U);
      text.remove_prefix(4);
    } else if (c == '\n' || c == '\r') {  // a line's end is no part of a string
      text.remove_prefix(1);
    } else if (const std::size_t whole = text_prefix(text); whole > 0) {
      const std::size_t plain = std::min(whole, text.find_first_of("\\'", 1));
      result += text.substr(0, plain);
      text.remove_prefix(plain);
    } else {
      append_utf8(result, static_cast<unsigned char>(c));
      text.remove_prefix(1);
    }
  }
  return result;
}

}  // namespace selvage::formats::step
