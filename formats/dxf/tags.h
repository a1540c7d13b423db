// DXF is a list of tags: a group code on one line, its value on the next.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/vec.h"

namespace selvage::formats::dxf {

// Names things in a drawing; unique in the file, written in hexadecimal.
using Handle = std::uint32_t;

// `text` as a string value: other characters than ASCII as \U+XXXX (those above FFFF and bytes that are not
// UTF-8 as '_'), '^' as "^ ", control characters as '_'.
std::string string_value(std::string_view text);

class Tags {
 public:
  Tags& text(int code, std::string_view value);  // as it is
  Tags& integer(int code, long long value);
  Tags& real(int code, double value);  // shortest exact form, with a point or an exponent
  Tags& handle(int code, Handle value);
  Tags& point(int code, const Vec3& p);  // code, code + 10, code + 20

  // "  0 / NAME", then handle, owner and class markers: the beginning of an entity or object.
  Tags& entity(std::string_view name, Handle self, Handle owner, std::string_view layer,
               std::string_view kind);
  // The beginning of a table's entry.
  Tags& record(std::string_view table, Handle self, Handle owner, std::string_view kind,
               std::string_view name);

  Tags& append(const Tags& other);
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace selvage::formats::dxf
