#include "formats/tg3/fields.h"

#include <fmt/format.h>

#include <cmath>

#include "core/number_text.h"
#include "core/words.h"

namespace selvage::formats::tg3 {

namespace {

constexpr double largest = 1e30;  // products of several of them are numbers still

}  // namespace

void Fields::error(const Message& message, TextPlace otherwise) const {
  if (is_full()) return;
  const TextPlace place = message.place.line > 0 ? message.place : otherwise;
  report_.error(spot_at(source_, place), message.text, message.kind);
}

std::string_view Fields::text(const Element& element, std::string_view name) const {
  const std::string* const value = element.attribute(name);
  return value != nullptr ? std::string_view(*value) : std::string_view();
}

std::vector<double> Fields::numbers(const Element& element, std::string_view name, std::size_t count) const {
  const std::string* const text = element.attribute(name);
  std::vector<double> values(count, 0.0);
  if (text == nullptr) {
    error(element, fmt::format("the element <{}> has no {}", element.name, name));
    return values;
  }
  const std::vector<std::string_view> words = split(*text, ',');
  bool is_good = words.size() == count;
  for (std::size_t i = 0; is_good && i < count; ++i) {
    const std::optional<double> value = read_number(trimmed(words[i]));
    is_good = value && std::abs(*value) <= largest;
    values[i] = is_good ? *value : 0.0;
  }
  if (!is_good)
    error(element,
          fmt::format("the {} of <{}> is {}: {} expected", name, element.name, in_quotes(*text),
                      count == 1
                          ? fmt::format("a decimal number within {0:g} and -{0:g} is", largest)
                          : fmt::format("{0} numbers within {1:g} and -{1:g} with commas between them are",
                                        count, largest)));
  return values;
}

double Fields::number(const Element& element, std::string_view name, std::optional<double> otherwise) const {
  if (otherwise && element.attribute(name) == nullptr) return *otherwise;
  return numbers(element, name, 1)[0];
}

double Fields::positive(const Element& element, std::string_view name) const {
  const int errors = this->errors();
  const double value = number(element, name);
  if (this->errors() == errors && !(value > 0))
    error(element,
          fmt::format("the {} of <{}> is {}: it has to be larger than 0", name, element.name, value));
  return value;
}

int Fields::whole(const Element& element, std::string_view name, int least, int most,
                  std::optional<int> otherwise) const {
  if (otherwise && element.attribute(name) == nullptr) return *otherwise;
  const int errors = this->errors();
  const double value = number(element, name);
  if (this->errors() != errors) return least;
  if (value == std::floor(value) && value >= least && value <= most) return static_cast<int>(value);
  error(element, fmt::format("the {} of <{}> is {}: a whole number from {} to {} is expected", name,
                             element.name, value, least, most));
  return least;
}

bool Fields::flag(const Element& element, std::string_view name, bool otherwise) const {
  return whole(element, name, 0, 1, otherwise ? 1 : 0) == 1;
}

Vec2 Fields::pair(const Element& element, std::string_view name) const {
  const std::vector<double> values = numbers(element, name, 2);
  return {values[0], values[1]};
}

Vec3 Fields::vector(const Element& element, std::string_view name,
                    const std::optional<Vec3>& otherwise) const {
  if (otherwise && element.attribute(name) == nullptr) return *otherwise;
  const std::vector<double> values = numbers(element, name, 3);
  return {values[0], values[1], values[2]};
}

}  // namespace selvage::formats::tg3
