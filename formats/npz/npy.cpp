#include "formats/npz/npy.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/little_endian.h"
#include "core/readable.h"

namespace selvage::formats::npz {
namespace {

std::u32string characters_of(std::string_view text) {
  constexpr char32_t replacement = 0xFFFD;  // of a byte that is no UTF-8
  std::u32string result;
  while (!text.empty()) {
    const Character one = take_character(text);
    result.push_back(one.is_valid ? one.code() : replacement);
  }
  return result;
}

}  // namespace

std::string npy_head(std::string_view type, const std::vector<std::size_t>& dimensions) {
  std::string shape;
  for (const std::size_t one : dimensions) shape += fmt::format("{}, ", one);
  std::string words = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", type, shape);
  std::string head("\x93NUMPY\x01\x00", 8);
  constexpr std::size_t step = 64, before = 10;  // data begin at a multiple of 64, after a line's end
  words.append((step - (before + words.size() + 1) % step) % step, ' ');
  words += '\n';
  append_little_endian(head, static_cast<std::uint16_t>(words.size()));
  return head + words;
}

TextArray text_array(std::span<const std::string> texts) {
  std::vector<std::u32string> all;
  std::size_t longest = 1;
  for (const std::string& text : texts)
    longest = std::max(longest, all.emplace_back(characters_of(text)).size());
  TextArray array{fmt::format("<U{}", longest), {}};
  for (std::u32string& text : all) {
    text.resize(longest, U'\0');
    for (const char32_t one : text) append_little_endian(array.data, static_cast<std::uint32_t>(one));
  }
  return array;
}

}  // namespace selvage::formats::npz
