#include "core/option.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>

#include "core/number_text.h"
#include "core/words.h"

namespace selvage {

namespace {

using Limits = std::numeric_limits<double>;

std::optional<std::int64_t> read_whole(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  std::int64_t value = 0;
  const auto [rest, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc() || rest != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string wanted(const Argument& argument) {
  if (argument.form == Argument::Form::word) return alternatives(words_of(argument.words));
  if (argument.form == Argument::Form::whole)
    return fmt::format("a whole number from {} to {}", argument.least, argument.most);
  if (argument.most < Limits::max()) return fmt::format("from {} to {}", argument.least, argument.most);
  return argument.least > 0 ? "a positive number" : "zero or a positive number";
}

}  // namespace

Argument Argument::positive() {
  return between(Limits::min(), Limits::max());
}

Argument Argument::non_negative() {
  return between(0, Limits::max());
}

Result<std::string> Argument::canonical(std::string_view given) const {
  const auto fits = [&](double value) { return value >= least && value <= most; };
  switch (form) {
    case Form::none:
    case Form::text:
    case Form::texts:
      return std::string(given);
    case Form::word:
      for (const std::string_view word : words_of(words))
        if (word == given || (any_case && same_word(word, given))) return std::string(word);
      break;
    case Form::whole:
      if (const auto value = read_whole(given); value && fits(static_cast<double>(*value)))
        return std::to_string(*value);
      break;
    case Form::real:
      if (const auto value = read_number(given); value && fits(*value)) return number_text(*value);
      break;
  }
  return selvage::error(Kind::usage, fmt::format("'{}' is not {}", given, wanted(*this)));
}

std::string Argument::in_help() const {
  switch (form) {
    case Form::none:
      return {};
    case Form::text:
    case Form::texts:
      return std::string(words);
    case Form::word: {
      std::string list(words);
      std::replace(list.begin(), list.end(), ' ', ',');
      return "{" + list + "}";
    }
    case Form::whole:
      return fmt::format("N in {}-{}", least, most);
    case Form::real:
      break;
  }
  if (most < Limits::max()) return fmt::format("X in {}-{}", least, most);
  return least > 0 ? "X>0" : "X>=0";
}

std::string_view Option::word() const {
  const std::string_view last = long_name();
  return last.substr(std::min(last.find_first_not_of('-'), last.size()));
}

std::string_view OptionValues::text(const Option& option) const {
  const auto found = given_.find(option.name);
  return found == given_.end() ? option.preset : std::string_view(found->second);
}

std::int64_t OptionValues::whole(const Option& option) const {
  return read_whole(text(option)).value_or(0);
}

}  // namespace selvage
