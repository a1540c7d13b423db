// Keyword lines of decks.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace selvage::formats::inp {

// Names and keywords count in any case.
std::string key_of(std::string_view text);

// "*SOLID SECTION, ELSET=a, MATERIAL=b": the word, and what its parameters are.
struct Card {
  std::string word;
  std::map<std::string, std::string> values;
  [[nodiscard]] std::string value(const std::string& name) const {
    const auto found = values.find(name);
    return found == values.end() ? std::string() : found->second;
  }
};
// Of a line that begins with '*'.
Card card_of(std::string_view line);

}  // namespace selvage::formats::inp
