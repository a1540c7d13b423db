#include "formats/dxf/tags.h"

#include <fmt/format.h>

#include "core/number_text.h"
#include "core/readable.h"

namespace selvage::formats::dxf {

std::string string_value(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const Character character = take_character(text);
    const char32_t code = character.is_valid ? character.code() : 0;
    if (code < 0x20 || code == 0x7F || code > 0xFFFF)
      out += '_';
    else if (code == '^')
      out += "^ ";
    else
      out += code < 0x80 ? std::string(character.bytes)
                         : fmt::format("\\U+{:04X}", static_cast<std::uint32_t>(code));
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
