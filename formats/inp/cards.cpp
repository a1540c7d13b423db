#include "formats/inp/cards.h"

#include <vector>

#include "core/words.h"

namespace selvage::formats::inp {

std::string key_of(std::string_view text) {
  std::string key(trimmed(text));
  for (char& letter : key)
    if (letter >= 'a' && letter <= 'z') letter = static_cast<char>(letter - 'a' + 'A');
  return key;
}

Card card_of(std::string_view line) {
  Card card;
  const std::vector<std::string_view> parts = split(line.substr(1), ',');
  if (parts.empty()) return card;
  card.word = key_of(parts.front());
  for (std::size_t k = 1; k < parts.size(); ++k) {
    const std::size_t is = parts[k].find('=');
    card.values[key_of(parts[k].substr(0, is))] =
        is == std::string_view::npos ? std::string() : std::string(trimmed(parts[k].substr(is + 1)));
  }
  return card;
}

}  // namespace selvage::formats::inp
