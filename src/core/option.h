// Options of the command line, each declared once, by whoever acts on it. Parsing, help, what goes together,
// and what `--resume` compares follow from the declaration; pipeline/command_line.h has the table of them.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "core/diagnostics.h"

namespace selvage {

// What stands behind an option's name.
struct Argument {
  enum class Form { none, text, texts, word, whole, real };
  Form form = Form::none;
  std::string_view words{};    // text: what help calls it ("FILE"); word: those that there are, by blanks
  double least = 0, most = 0;  // of numbers; both are allowed
  bool any_case = false;       // of words

  static constexpr Argument text(std::string_view name) { return {Form::text, name}; }
  static constexpr Argument texts(std::string_view name) { return {Form::texts, name}; }
  static constexpr Argument one_of(std::string_view words, bool any_case = false) {
    return {.form = Form::word, .words = words, .any_case = any_case};
  }
  static constexpr Argument whole(std::int64_t least, std::int64_t most) {
    return {Form::whole, {}, static_cast<double>(least), static_cast<double>(most)};
  }
  static constexpr Argument between(double least, double most) { return {Form::real, {}, least, most}; }
  static Argument positive();
  static Argument non_negative();

  // The one spelling of a value: what is a number as number_text() has it, a word as it is declared, a text
  // as it is. Error (usage): it is no such value.
  [[nodiscard]] Result<std::string> canonical(std::string_view given) const;
  // For help: "{patch,fan}", "FILE", "N in 1-4096".
  [[nodiscard]] std::string in_help() const;
};

struct Option {
  std::string_view name;  // "--size", or "-o,--output"; without a dash its place in the line tells it
  std::string_view help;
  Argument argument{};        // none: a flag
  std::string_view preset{};  // the value where none is given; empty: there is none, or `help` tells it
  bool is_required = false;
  bool is_of_run = false;  // says how the program runs: no byte of an output depends on it
  // Where it is given, one at least of `needs` and none of `not_with` has to be: names of options, by blanks.
  // Those that the subcommand does not have do not count. `why` goes behind the name: "is of the matrix".
  std::string_view why{}, needs{}, not_with{};
  std::string_view only_as{};  // the value for which that holds; empty: all but the preset

  Option& with_preset(std::string_view value) { return preset = value, *this; }
  Option& required() { return is_required = true, *this; }
  Option& of_run() { return is_of_run = true, *this; }
  Option& goes_with(std::string_view reason, std::string_view these, std::string_view not_these,
                    std::string_view only = {}) {
    return why = reason, needs = these, not_with = not_these, only_as = only, *this;
  }

  // The last of its names, and that without dashes: "--output", "output".
  [[nodiscard]] std::string_view long_name() const { return name.substr(name.find(',') + 1); }
  [[nodiscard]] std::string_view word() const;
};

// Values that were given, in their canonical spelling.
class OptionValues {
 public:
  void set(const Option& option, std::string value = {}) {
    given_[std::string(option.name)] = std::move(value);
  }
  [[nodiscard]] bool has(const Option& option) const { return given_.contains(option.name); }
  // The value, or the preset.
  [[nodiscard]] std::string_view text(const Option& option) const;
  [[nodiscard]] std::int64_t whole(const Option& option) const;

 private:
  std::map<std::string, std::string, std::less<>> given_;
};

}  // namespace selvage
