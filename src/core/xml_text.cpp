#include "core/xml_text.h"

#include <array>
#include <utility>

#include "core/readable.h"

namespace selvage {

namespace {

bool is_known(std::string_view character) {
  const auto first = static_cast<unsigned char>(character.front());
  return first >= 0x20 ? character != "\xEF\xBF\xBE" && character != "\xEF\xBF\xBF"
                       : first == '\t' || first == '\n' || first == '\r';
}

// What stands for a character that means something to XML; else empty.
std::string_view entity_of(std::string_view character) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> entities = {
      {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}, {"\r", "&#13;"}}};
  for (const auto& [letter, entity] : entities)
    if (letter == character) return entity;
  return {};
}

}  // namespace

std::string xml_text(std::string_view text, std::string_view unknown) {
  std::string out;
  while (!text.empty()) {
    const Character one = take_character(text);
    const std::string_view entity = entity_of(one.bytes);
    out += !one.is_valid || !is_known(one.bytes) ? unknown : entity.empty() ? one.bytes : entity;
  }
  return out;
}

}  // namespace selvage
