#include "formats/dxf/tags.h"

#include <fmt/format.h>

#include "core/number_text.h"
#include "core/text_report.h"

namespace selvage::formats::dxf {

namespace {

// The code of the UTF-8 character at the beginning of `text`, which is whole; `length` is set.
std::uint32_t code_point(std::string_view text, std::size_t& length) {
  const auto byte = [text](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i]));
  };
  length = byte(0) < 0x80 ? 1 : byte(0) < 0xE0 ? 2 : byte(0) < 0xF0 ? 3 : 4;
  if (length == 1) return byte(0);
  std::uint32_t code = byte(0) & (0x7FU >> length);
  for (std::size_t i = 1; i < length; ++i) code = code << 6U | (byte(i) & 0x3FU);
  return code;
}

}  // namespace

std::string string_value(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    std::string_view good = text.substr(0, text_prefix(text));
    text.remove_prefix(good.size());
    while (!good.empty()) {
      std::size_t length = 1;
      const std::uint32_t code = code_point(good, length);
      if (code == '^')
        out += "^ ";
      else if (code < 0x80)
        out += code < 0x20 ? '_' : static_cast<char>(code);
      else
        out += code > 0xFFFF ? std::string("_") : fmt::format("\\U+{:04X}", code);
      good.remove_prefix(length);
    }
    if (text.empty()) break;
    out += '_';
    text.remove_prefix(1);
  }
  return out;
}

Tags& Tags::text(int code, std::string_view value) {
  fmt::format_to(std::back_inserter(bytes_), "{:>3}\n{}\n", code, value);
  return *this;
}

Tags& Tags::integer(int code, long long value) {
  return text(code, std::to_string(value));
}

Tags& Tags::real(int code, double value) {
  std::string number = number_text(value + 0.0);  // no negative zero
  if (number.find_first_of(".e") == std::string::npos) number += ".0";
  return text(code, number);
}

Tags& Tags::handle(int code, Handle value) {
  return text(code, fmt::format("{:X}", value));
}

Tags& Tags::point(int code, const Vec3& p) {
  return real(code, p.x()).real(code + 10, p.y()).real(code + 20, p.z());
}

Tags& Tags::entity(std::string_view name, Handle self, Handle owner, std::string_view layer,
                   std::string_view kind) {
  return text(0, name)
      .handle(5, self)
      .handle(330, owner)
      .text(100, "AcDbEntity")
      .text(8, layer)
      .text(100, kind);
}

Tags& Tags::record(std::string_view table, Handle self, Handle owner, std::string_view kind,
                   std::string_view name) {
  return text(0, table)
      .handle(table == "DIMSTYLE" ? 105 : 5, self)
      .handle(330, owner)
      .text(100, "AcDbSymbolTableRecord")
      .text(100, kind)
      .text(2, name);
}

Tags& Tags::append(const Tags& other) {
  bytes_ += other.bytes_;
  return *this;
}

}  // namespace selvage::formats::dxf
