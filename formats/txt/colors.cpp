#include "formats/txt/colors.h"

#include <array>
#include <charconv>

#include "core/words.h"

namespace selvage::formats::txt {

namespace {

struct Named {
  std::string_view name;
  unsigned value;  // 0xRRGGBB
};
constexpr std::array colors = {
    Named{"black", 0x000000},     Named{"white", 0xffffff},    Named{"gray", 0x808080},
    Named{"grey", 0x808080},      Named{"silver", 0xc0c0c0},   Named{"red", 0xff0000},
    Named{"green", 0x008000},     Named{"blue", 0x0000ff},     Named{"yellow", 0xffff00},
    Named{"orange", 0xffa500},    Named{"purple", 0x800080},   Named{"brown", 0xa52a2a},
    Named{"pink", 0xffc0cb},      Named{"navy", 0x000080},     Named{"indigo", 0x4b0082},
    Named{"teal", 0x008080},      Named{"olive", 0x808000},    Named{"maroon", 0x800000},
    Named{"lime", 0x00ff00},      Named{"cyan", 0x00ffff},     Named{"magenta", 0xff00ff},
    Named{"gold", 0xffd700},      Named{"beige", 0xf5f5dc},    Named{"ivory", 0xfffff0},
    Named{"khaki", 0xf0e68c},     Named{"tan", 0xd2b48c},      Named{"linen", 0xfaf0e6},
    Named{"salmon", 0xfa8072},    Named{"coral", 0xff7f50},    Named{"crimson", 0xdc143c},
    Named{"turquoise", 0x40e0d0}, Named{"violet", 0xee82ee},   Named{"chocolate", 0xd2691e},
    Named{"lavender", 0xe6e6fa},  Named{"steelblue", 0x4682b4}};

fabric::Color color_of(unsigned value) {
  return {static_cast<int>(value >> 16U & 255U), static_cast<int>(value >> 8U & 255U),
          static_cast<int>(value & 255U)};
}

}  // namespace

std::optional<fabric::Color> color_named(std::string_view text) {
  for (const Named& named : colors)
    if (same_word(named.name, text)) return color_of(named.value);
  if (text.size() != 7 || text.front() != '#') return std::nullopt;
  unsigned value = 0;
  const auto [stop, failure] = std::from_chars(text.data() + 1, text.data() + text.size(), value, 16);
  if (failure != std::errc() || stop != text.data() + text.size()) return std::nullopt;
  return color_of(value);
}

std::vector<std::string_view> color_names() {
  std::vector<std::string_view> names;
  names.reserve(colors.size());
  for (const Named& named : colors) names.push_back(named.name);
  return names;
}

}  // namespace selvage::formats::txt
