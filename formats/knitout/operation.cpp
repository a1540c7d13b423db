#include "formats/knitout/operation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "core/number_text.h"

namespace selvage::formats::knitout {

namespace {

// What stands behind the word: a direction, one needle or two, a racking, two numbers; carriers where
// `carriers` says so.
struct Form {
  std::string_view word;
  Verb verb;
  bool direction = false;
  int needles = 0, numbers = 0;
  enum class Carriers { no, any, some } carriers = Carriers::no;
  std::string_view grammar;
};

constexpr std::array<Form, 15> forms = {{
    {"in", Verb::in, false, 0, 0, Form::Carriers::some, "in CARRIERS"},
    {"inhook", Verb::inhook, false, 0, 0, Form::Carriers::some, "inhook CARRIERS"},
    {"releasehook", Verb::releasehook, false, 0, 0, Form::Carriers::some, "releasehook CARRIERS"},
    {"out", Verb::out, false, 0, 0, Form::Carriers::some, "out CARRIERS"},
    {"outhook", Verb::outhook, false, 0, 0, Form::Carriers::some, "outhook CARRIERS"},
    {"knit", Verb::knit, true, 1, 0, Form::Carriers::any, "knit DIRECTION NEEDLE [CARRIERS]"},
    {"tuck", Verb::tuck, true, 1, 0, Form::Carriers::any, "tuck DIRECTION NEEDLE [CARRIERS]"},
    {"split", Verb::split, true, 2, 0, Form::Carriers::any, "split DIRECTION NEEDLE NEEDLE [CARRIERS]"},
    {"miss", Verb::miss, true, 1, 0, Form::Carriers::any, "miss DIRECTION NEEDLE [CARRIERS]"},
    {"drop", Verb::drop, false, 1, 0, Form::Carriers::no, "drop NEEDLE"},
    {"amiss", Verb::amiss, false, 1, 0, Form::Carriers::no, "amiss NEEDLE"},
    {"xfer", Verb::xfer, false, 2, 0, Form::Carriers::no, "xfer NEEDLE NEEDLE"},
    {"rack", Verb::rack, false, 0, 1, Form::Carriers::no, "rack NEEDLES"},
    {"stitch", Verb::stitch, false, 0, 2, Form::Carriers::no, "stitch BEFORE AFTER"},
    {"pause", Verb::pause, false, 0, 0, Form::Carriers::no, "pause"},
}};

std::vector<std::string_view> all_words() {
  std::vector<std::string_view> words;
  words.reserve(forms.size());
  for (const Form& form : forms) words.push_back(form.word);
  return words;
}

class Line {
 public:
  Line(std::string_view line, const Spot& begin, TextReport& report)
      : line_(line), rest_(line), begin_(begin), report_(report) {}

  std::optional<Carrier> word() {
    std::optional<Carrier> next = next_word(rest_, line_, begin_);
    if (next) last_ = next->spot;
    return next;
  }
  // The same, or an error that says what should stand there.
  std::optional<Carrier> word(std::string_view what, const Form& form) {
    std::optional<Carrier> next = word();
    if (!next) report_.error(end(), fmt::format("{} is missing: {}", what, form.grammar));
    return next;
  }
  std::nullopt_t error(const Carrier& at, std::string text, Kind kind = Kind::malformed) {
    return report_.error(at.spot, std::move(text), kind);
  }
  std::optional<int> direction(const Form& form);
  std::optional<Needle> needle(const Form& form, Spot& spot);
  std::optional<double> number(const Form& form);

 private:
  [[nodiscard]] Spot end() const {
    std::size_t size = line_.size();
    while (size > 0 && (line_[size - 1] == ' ' || line_[size - 1] == '\t' || line_[size - 1] == '\r')) --size;
    return begin_.behind(size);
  }

  std::string_view line_, rest_;
  Spot begin_;
  TextReport& report_;
  Spot last_;
};

std::optional<int> Line::direction(const Form& form) {
  const std::optional<Carrier> next = word("the direction", form);
  if (!next) return std::nullopt;
  if (next->name == "+") return 1;
  if (next->name == "-") return -1;
  return error(*next,
               fmt::format("{} is no direction: + (to the right) or - (to the left)", in_quotes(next->name)));
}

std::optional<Needle> Line::needle(const Form& form, Spot& spot) {
  const std::optional<Carrier> next = word("the needle", form);
  if (!next) return std::nullopt;
  spot = next->spot;
  std::string_view text = next->name;
  Needle needle;
  const bool has_bed = text.starts_with('f') || text.starts_with('b');
  if (text.starts_with('b')) needle.bed = Bed::back;
  if (has_bed) text.remove_prefix(1);
  needle.is_slider = has_bed && text.starts_with('s');
  if (needle.is_slider) text.remove_prefix(1);
  const auto [stop, code] = std::from_chars(text.data(), text.data() + text.size(), needle.number);
  if (!has_bed || text.empty() || stop != text.data() + text.size() || code == std::errc::invalid_argument)
    return error(*next, fmt::format("{} is no needle: f or b (fs, bs: a slider) and a whole number, as f12",
                                    in_quotes(next->name)));
  if (code != std::errc() || std::abs(needle.number) > most_number)
    return error(*next,
                 fmt::format("needle {} is beyond every bed: numbers go from {} to {}", in_quotes(next->name),
                             -most_number, most_number),
                 Kind::limit);
  return needle;
}

std::optional<double> Line::number(const Form& form) {
  const std::optional<Carrier> next = word("a number", form);
  if (!next) return std::nullopt;
  const std::optional<double> value = read_number(next->name);
  if (value) return value;
  const bool has_comma = next->name.find(',') != std::string_view::npos;
  return error(*next, fmt::format("{} is no number{}", in_quotes(next->name),
                                  has_comma ? ": the decimal mark is the point" : ""));
}

}  // namespace

std::optional<Carrier> next_word(std::string_view& rest, std::string_view line, const Spot& begin) {
  constexpr std::string_view blanks = " \t\r";
  const std::size_t start = rest.find_first_not_of(blanks);
  if (start == std::string_view::npos) return std::nullopt;
  rest.remove_prefix(start);
  const std::size_t length = std::min(rest.find_first_of(blanks), rest.size());
  Carrier word{rest.substr(0, length), begin.behind(static_cast<std::size_t>(rest.data() - line.data()))};
  rest.remove_prefix(length);
  return word;
}

bool read_operation(std::string_view line, const Spot& begin, Operation& operation, TextReport& report) {
  Line words(line, begin, report);
  const std::optional<Carrier> first = words.word();
  if (!first) return false;
  operation.word = first->name;
  operation.spot = first->spot;
  operation.carriers.clear();
  operation.direction = 1;
  if (first->name.starts_with("x-")) {
    operation.verb = Verb::extension;
    return true;
  }
  const auto* const form =
      std::find_if(forms.begin(), forms.end(), [&](const Form& one) { return one.word == first->name; });
  if (form == forms.end()) {
    report.error(first->spot, fmt::format("unknown operation {}{}", in_quotes(first->name),
                                          did_you_mean(first->name, all_words())));
    return false;
  }
  operation.verb = form->verb;
  if (form->direction) {
    const std::optional<int> direction = words.direction(*form);
    if (!direction) return false;
    operation.direction = *direction;
  }
  for (int i = 0; i < form->needles; ++i) {
    const std::optional<Needle> needle =
        words.needle(*form, i == 0 ? operation.needle_spot : operation.other_spot);
    if (!needle) return false;
    (i == 0 ? operation.needle : operation.other) = *needle;
  }
  for (int i = 0; i < form->numbers; ++i) {
    const std::optional<double> value = words.number(*form);
    if (!value) return false;
    operation.racking = *value;
  }
  while (const std::optional<Carrier> carrier = words.word()) {
    if (form->carriers == Form::Carriers::no) {
      words.error(*carrier, fmt::format("{} is too much: {}", in_quotes(carrier->name), form->grammar));
      return false;
    }
    operation.carriers.push_back(*carrier);
  }
  if (form->carriers == Form::Carriers::some && operation.carriers.empty())
    return words.word("the carrier", *form).has_value();
  return true;
}

}  // namespace selvage::formats::knitout
