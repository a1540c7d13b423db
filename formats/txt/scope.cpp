#include "formats/txt/scope.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/text_report.h"
#include "core/words.h"
#include "formats/txt/words.h"

namespace selvage::formats::txt {

namespace {

constexpr std::size_t longest_expression = 1000;  // characters

// Those of muParser, and what it gives besides.
constexpr std::array<std::string_view, 26> functions = {
    "sin",  "cos",  "tan", "asin", "acos",  "atan",  "atan2", "sinh", "cosh",
    "tanh", "log2", "log", "ln",   "exp",   "sqrt",  "sign",  "rint", "abs",
    "min",  "max",  "sum", "avg",  "asinh", "acosh", "atanh", "log10"};
constexpr std::string_view circle_number = "pi";

// Words that begin statements, and those of units that stand alone.
constexpr std::array keywords = {
    "fabric",    "title",      "units",    "tolerance", "thread",       "material",    "yarn",
    "weave",     "knit",       "warpknit", "braid",     "piece",        "edit",        "cell",
    "param",     "end",        "tex",      "dtex",      "denier",       "Td",          "Nm",
    "Ne",        "density",    "packing",  "diameter",  "section",      "twist",       "plies",
    "filaments", "color",      "elastic",  "expansion", "conductivity", "diffusivity", "permittivity",
    "role",      "path",       "grid",     "group",     "ends",         "closed",      "tangent",
    "up",        "degree",     "knots",    "open",      "corners",      "centre",      "warp",
    "weft",      "draft",      "profile",  "crimp",     "layers",       "binder",      "courses",
    "wales",     "method",     "chart",    "bar",       "stitch",       "carriers",    "pattern",
    "radius",    "flat",       "angle",    "length",    "axial",        "line",        "curve",
    "matrix",    "periodic",   "K",        "fixed",     "nan",          "inf",         "infinity",
    "outline",   "derivative", "spacing",  "thickness", "loop",         "feeds",       "gating",
    "plating",   "pile",       "block",    "use",       "place",        "rotate",      "mirror",
    "shear",     "repeat",     "margin",   "substrate", "points",       "helix",       "pucker",
    "mandrel",   "unit",       "crossing", "shape",     "transfer",     "drop",        "interface",
    "stiffness", "strength",   "energy",   "planar",    "fill",         "colour",      "state",
    "levels",    "fraction",   "compact"};

bool continues_identifier(char c) {
  return starts_name(c) || (c >= '0' && c <= '9');
}

// A number at the beginning of the text: how many characters it has; 0: none. `value`: finite.
std::size_t leading_number(std::string_view text, double& value) {
  std::size_t sign = 0;
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') sign = 1;
  const auto [stop, failure] = std::from_chars(text.data() + sign, text.data() + text.size(), value);
  if (failure != std::errc{} || !std::isfinite(value)) return 0;
  return static_cast<std::size_t>(stop - text.data());
}

const NumberUnit* find_unit(std::string_view word) {
  const auto found = std::find_if(number_units.begin(), number_units.end(),
                                  [&](const NumberUnit& unit) { return same_word(unit.word, word); });
  return found == number_units.end() ? nullptr : &*found;
}

bool takes(Measure measure, Measure of_unit) {
  return measure == of_unit || measure == Measure::any ||
         (measure == Measure::pitch && of_unit == Measure::length);
}

// "mm, cm, ...": what a number that measures this may carry.
std::string units_of(Measure measure) {
  std::string list;
  for (const NumberUnit& unit : number_units)
    if (takes(measure, unit.measure)) list += fmt::format("{}{}", list.empty() ? "" : ", ", unit.word);
  if (measure == Measure::pitch || measure == Measure::twist) list += ", or so many on a length, as in 26/cm";
  return list;
}

// Calls visit(name) for the names of an expression that are no functions and no units behind numbers, until
// it says false.
template <class Visit>
void for_each_name(std::string_view text, const Visit& visit) {
  for (std::size_t i = 0; i < text.size();) {
    if ((text[i] >= '0' && text[i] <= '9') || text[i] == '.') {
      double value = 0;
      i += std::max<std::size_t>(1, leading_number(text.substr(i), value));
      while (i < text.size() && is_letter(text[i])) ++i;  // its unit
      continue;
    }
    std::size_t stop = i;
    while (stop < text.size() && continues_identifier(text[stop])) ++stop;
    if (stop == i) {
      ++i;
      continue;
    }
    const std::string_view name = text.substr(i, stop - i);
    const bool is_behind_value = i > 0 && text[i - 1] == ')';
    const bool is_function = stop < text.size() && text[stop] == '(';
    if (!is_function && !is_behind_value && name != circle_number && !visit(name)) return;
    i = stop;
  }
}

Message wrong(std::string_view text, std::string_view what) {
  return error(Kind::malformed, fmt::format("{}: {}", in_quotes(text), what));
}

}  // namespace

bool is_reserved(std::string_view word) {
  const auto is_word = [&](std::string_view known) { return same_word(known, word); };
  return std::any_of(keywords.begin(), keywords.end(), is_word) ||
         std::any_of(functions.begin(), functions.end(), is_word) || same_word(word, circle_number) ||
         find_unit(word) != nullptr;
}

std::span<const std::string_view> function_names() {
  return functions;
}

bool is_identifier(std::string_view text) {
  return !text.empty() && starts_name(text.front()) &&
         std::all_of(text.begin(), text.end(), continues_identifier);
}

bool Scope::set_unit(Unit unit) {
  if (has_used_unit_ && unit != unit_) return false;
  unit_ = unit;
  return true;
}

std::optional<int> Scope::define(std::string_view name, double value, bool is_count, int line) {
  for (std::size_t i = 0; i < values_.size(); ++i)
    if (values_[i].name == name) return params_[i].line;
  values_.push_back({std::string(name), value});
  params_.push_back({is_count, line});
  return std::nullopt;
}

std::vector<std::string_view> Scope::names() const {
  std::vector<std::string_view> names;
  for (const NamedValue& value : values_) names.push_back(value.name);
  return names;
}

bool Scope::begins_with_param(std::string_view text) const {
  const auto stop = std::find_if_not(text.begin(), text.end(), continues_identifier);
  const std::string_view name(text.begin(), stop);
  return std::any_of(values_.begin(), values_.end(), [&](const NamedValue& v) { return v.name == name; });
}

bool Scope::is_length(std::string_view text) {
  double number = 0;
  const std::size_t digits = leading_number(text, number);
  const NumberUnit* const unit =
      digits > 0 && digits < text.size() ? find_unit(text.substr(digits)) : nullptr;
  return unit != nullptr && unit->measure == Measure::length;
}

const NumberUnit* Scope::unit_of(std::string_view word, Measure measure) {
  const NumberUnit* const unit = find_unit(word);
  return unit != nullptr && takes(measure, unit->measure) ? unit : nullptr;
}

double Scope::in_file_units(const NumberUnit& unit) const {
  return unit.measure == Measure::length ? unit.size / millimetres_per(unit_) : unit.size;
}

// A text that ends in `/cm` or `/10cm`.
std::optional<Scope::Count> Scope::count_on_length(std::string_view text) {
  const std::size_t slash = text.rfind('/');
  if (slash == std::string_view::npos || slash == 0) return std::nullopt;
  const std::string_view behind = text.substr(slash + 1);
  double lengths = 1.0;
  const std::size_t digits = leading_number(behind, lengths);
  const NumberUnit* const unit = find_unit(behind.substr(digits));
  if (unit == nullptr || unit->measure != Measure::length || !(lengths > 0.0)) return std::nullopt;
  has_used_unit_ = true;
  return Count{text.substr(0, slash), lengths * in_file_units(*unit)};
}

// A number and nothing but its unit. None: it is not that.
std::optional<Result<double>> Scope::with_unit(std::string_view text, Measure measure) {
  double number = 0;
  const std::size_t digits = leading_number(text, number);
  if (digits == 0 || digits == text.size()) return std::nullopt;
  const std::string_view word = text.substr(digits);
  const NumberUnit* const unit = find_unit(word);
  if (unit == nullptr) {
    if (!std::all_of(word.begin(), word.end(), is_letter)) return std::nullopt;
    if (measure == Measure::plain) return wrong(text, "a number without a unit stands here");
    return wrong(text, fmt::format("{} is no unit; known here: {}", in_quotes(word), units_of(measure)));
  }
  if (!takes(measure, unit->measure)) {
    if (measure == Measure::plain) return wrong(text, "a number without a unit stands here");
    return wrong(text, fmt::format("the unit {} does not belong here; known here: {}", in_quotes(unit->word),
                                   units_of(measure)));
  }
  if (unit->measure == Measure::length) has_used_unit_ = true;
  const double size = in_file_units(*unit);
  // One rounding where the unit is a whole part of the file's.
  return size < 1.0 ? number / (1.0 / size) : number * size;
}

// Are all of its names known?
Status Scope::check_names(std::string_view text, Measure measure) const {
  Status status;
  for_each_name(text, [&](std::string_view name) {
    const auto found = std::find_if(values_.begin(), values_.end(),
                                    [&](const NamedValue& value) { return value.name == name; });
    if (same_word(name, "nan") || same_word(name, "inf") || same_word(name, "infinity")) {
      status = wrong(text, "it is no finite number");
    } else if (found == values_.end() && find_unit(name) != nullptr) {
      status = wrong(text, text.ends_with(fmt::format("/{}", name))
                               ? std::string("so many on a length are a pitch, which does not belong here")
                               : fmt::format("a unit stands right behind its number, as in 3{}", name));
    } else if (found == values_.end()) {
      const std::vector<std::string_view> known = names();
      std::string hint = did_you_mean(name, known);
      if (hint.empty() && known.empty()) hint = "; a line 'param NAME VALUE' above would define it";
      if (hint.empty()) hint = fmt::format("; above this line there are: {}", fmt::join(known, ", "));
      status = wrong(text, fmt::format("there is no param {}{}", in_quotes(name), hint));
    } else if (measure == Measure::twist &&
               params_[static_cast<std::size_t>(found - values_.begin())].is_count) {
      status =
          wrong(text, fmt::format("{} is a distance, since it was given as so many on a length: for turns "
                                  "give the number alone",
                                  in_quotes(name)));
    }
    return status.ok();
  });
  return status;
}

Result<double> Scope::expression(std::string_view text, Measure measure) {
  if (double number = 0; leading_number(text, number) == text.size()) return number;
  if (text.size() > longest_expression)
    return wrong(text, fmt::format("an expression has at most {} characters", longest_expression));
  if (Status known = check_names(text, measure); !known) return known.error();
  // A param alone, without opening anything.
  for (const NamedValue& value : values_)
    if (value.name == text) return value.value;
  std::vector<NamedValue> units;
  for (const NumberUnit& unit : number_units)
    if (std::all_of(unit.word.begin(), unit.word.end(), is_letter))
      units.push_back({std::string(unit.word), in_file_units(unit)});
  has_used_unit_ = true;  // it may have
  Result<double> value = value_of(text, values_, units);
  return value.ok() || value.error().kind != Kind::malformed ? value : wrong(text, value.error().text);
}

// What is more than one number: with brackets, an operator behind a value, or a name where there are params.
bool Scope::is_expression(std::string_view text) const {
  if (text.find('(') != std::string_view::npos) return true;
  if (text.find(',') != std::string_view::npos) return false;
  const std::string_view unsigned_text = text.substr(text.front() == '-' || text.front() == '+' ? 1 : 0);
  if (is_identifier(unsigned_text)) return !values_.empty();
  double number = 0;
  std::size_t i = leading_number(text, number);
  for (i = std::max<std::size_t>(i, 1); i < text.size(); ++i)
    if (std::string_view("+-*/^<>=!?:&|").find(text[i]) != std::string_view::npos)
      return continues_identifier(text[i - 1]) || text[i - 1] == '.';
  return false;
}

std::optional<Result<double>> Scope::value(std::string_view text, Measure measure) {
  if (double number = 0; leading_number(text, number) == text.size()) return number;
  if (std::optional<Result<double>> number = with_unit(text, measure)) return number;
  const bool may_be_count = measure == Measure::pitch || measure == Measure::twist || measure == Measure::any;
  const std::optional<Count> count = may_be_count ? count_on_length(text) : std::nullopt;
  if (count) {
    Result<double> number = expression(count->number, Measure::plain);
    if (!number) return number;
    if (measure == Measure::twist) return *number / count->length * (1000.0 / millimetres_per(unit_));
    if (!(*number > 0.0)) return wrong(text, "so many on a length have to be more than 0");
    return count->length / *number;
  }
  if (!is_expression(text)) return std::nullopt;
  return expression(text, measure);
}

}  // namespace selvage::formats::txt
