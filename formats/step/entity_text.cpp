#include "formats/step/entity_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/pointed_number.h"
#include "formats/step/character.h"

namespace selvage::formats::step {

namespace {

// Leaves room for the brackets that may follow the last token.
constexpr std::size_t filled_to = 72;

}  // namespace

std::string encoded(std::string_view text) {
  std::string quoted = "'";
  while (!text.empty()) {
    const char32_t code = take_code(text);
    if (code == U'\'')
      quoted += "''";
    else if (code >= 0x20 && code < 0x7F && code != U'\\')
      quoted += static_cast<char>(code);
    else
      quoted += code < 0x10000 ? fmt::format("\\X2\\{:04X}\\X0\\", static_cast<unsigned>(code))
                               : fmt::format("\\X4\\{:08X}\\X0\\", static_cast<unsigned>(code));
  }
  return quoted + '\'';
}

void EntityText::begin(Id id) {
  value(id);
  token(" = ");
}

void EntityText::end() {
  text_ << ";\n";
  column_ = 0;
  before_ = '\n';
}

void EntityText::token(std::string_view token) {
  if (token.empty()) return;
  if (column_ + token.size() > filled_to && (before_ == ',' || before_ == '(' || before_ == ' ')) {
    text_ << '\n';
    column_ = 0;
  }
  text_ << token;
  before_ = token.back();
  column_ = before_ == '\n' ? 0 : column_ + token.size();
}

void EntityText::value(Id id) {
  char word[max_number_length + 1] = "#";
  const char* const last = write_number(word + 1, static_cast<long long>(id.number));
  token({word, static_cast<std::size_t>(last - word)});
}

void EntityText::value(int number) {
  char word[max_number_length];
  const char* const last = write_number(word, static_cast<long long>(number));
  token({word, static_cast<std::size_t>(last - word)});
}

void EntityText::value(double number) {
  char word[max_number_length];
  const char* const last = write_pointed(word, number);
  token({word, static_cast<std::size_t>(last - word)});
}

}  // namespace selvage::formats::step
