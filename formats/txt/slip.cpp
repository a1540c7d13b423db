#include "formats/txt/slip.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "core/words.h"
#include "formats/txt/count.h"
#include "formats/txt/trade_draft.h"
#include "formats/txt/words.h"

namespace selvage::formats::txt {

namespace {

bool begins_as_number(std::string_view text) {
  return !text.empty() && ((text.front() >= '0' && text.front() <= '9') || text.front() == '.');
}

std::string_view rest_behind(std::string_view line, std::string_view word) {
  return trimmed(line.substr(static_cast<std::size_t>(word.data() + word.size() - line.data())));
}

// `cpc 18`, `wpi = 33`: in a knit.
std::optional<std::string> density(std::string_view short_form, std::string_view value) {
  struct Known {
    std::string_view word, system, behind;
  };
  constexpr std::array<Known, 4> known = {{{"cpc", "courses", "/cm"},
                                           {"cpi", "courses", "/in"},
                                           {"wpc", "wales", "/cm"},
                                           {"wpi", "wales", "/in"}}};
  for (const Known& form : known)
    if (same_word(form.word, short_form) && begins_as_number(value) &&
        value.find_first_not_of("0123456789.") == std::string_view::npos)
      return fmt::format("{} 8 {}{}", form.system, value, form.behind);
  return std::nullopt;
}

// Half of `24`, `24mm`, `24 mm`.
std::optional<std::string> half_of(std::string_view length) {
  double value = 0;
  const auto [stop, failure] = std::from_chars(length.data(), length.data() + length.size(), value);
  if (failure != std::errc{} || !(value > 0)) return std::nullopt;
  const std::string_view unit = trimmed(length.substr(static_cast<std::size_t>(stop - length.data())));
  if (!std::all_of(unit.begin(), unit.end(), is_letter)) return std::nullopt;
  return fmt::format("{:.12g}{}", value / 2, unit);
}

// `GB1`, `L2`, `gb`: a guide bar by its number.
bool is_guide_bar(std::string_view word) {
  std::size_t letters = 0;
  while (letters < word.size() && is_letter(word[letters])) ++letters;
  const std::string_view name = word.substr(0, letters), number = word.substr(letters);
  constexpr std::string_view guide_bar = "GB", legebarre = "L";
  const bool has_digits = number.find_first_not_of("0123456789") == std::string_view::npos;
  return has_digits && (same_word(name, guide_bar) || (same_word(name, legebarre) && !number.empty()));
}

// `tricot`, `rib 1x1`, `warp knit`: what a cloth is called without the word of its block.
std::optional<std::string> cloth_named(std::string_view line, const std::vector<std::string_view>& parts) {
  if (parts.size() > 1 && same_word(parts[0], "warp") && same_word(parts[1], "knit"))
    return std::string(trimmed(fmt::format("warpknit {}", rest_behind(line, parts[1]))));
  for (const auto& known : classic_words)
    if (parts.size() == 1 && same_word(known.text, parts[0]) && known.text != "satin")
      return fmt::format("warpknit {}", known.text);
  for (const auto& known : knit_words)
    if (same_word(known.text, parts[0])) return fmt::format("knit {}", line);
  return std::nullopt;
}

bool is_draft(std::string_view text) {
  Draft draft;
  const std::string_view word = text.substr(0, text.find_first_of(" \t"));
  return draft_of_trade(text, draft) ||
         std::any_of(draft_words.begin(), draft_words.end(), [&](const auto& known) {
           return known.value != Draft::Form::file && same_word(known.text, word);
         });
}

}  // namespace

std::optional<std::string> meant_line(std::string_view kind, std::string_view line,
                                      const std::vector<std::string_view>& words) {
  const std::vector<std::string_view> parts = words_of(line);
  if (parts.empty()) return std::nullopt;
  const auto is_known = [&](std::string_view word) {
    return std::any_of(words.begin(), words.end(), [&](auto known) { return same_word(known, word); });
  };
  const std::string_view first = parts.front(), rest = rest_behind(line, first);
  if (is_known("tex"))
    if (std::optional<std::string> count = count_of_glass(line)) return count;
  if (kind == "weave") {
    if (is_draft(line)) return fmt::format("draft {}", line);
    if (same_word(first, kind) && is_draft(rest)) return fmt::format("draft {}", rest);
  }
  if (kind.empty()) return cloth_named(line, parts);
  if (kind == "warpknit" && is_guide_bar(first)) return fmt::format("bar {}", rest);
  if (same_word(first, kind) && parts.size() > 2 && is_known(parts[1])) return std::string(rest);
  if (begins_as_number(first) && parts.size() == 2 && is_known(parts[1]))
    return fmt::format("{} {}", parts[1], first);
  if (kind == "braid" && same_word(first, "diameter"))
    if (const std::optional<std::string> radius = half_of(rest)) return fmt::format("radius {}", *radius);
  if (kind == "braid")
    for (const std::string_view sign : {"\xC2\xB1", "+-", "+/-"})
      if (line.starts_with(sign)) return fmt::format("angle {}", line.substr(sign.size()));
  return is_known("courses") && is_known("wales") ? density(first, rest) : std::nullopt;
}

std::string instead_of_knit(std::string_view text) {
  const std::vector<std::string_view> words = words_of(text);
  if (words.empty()) return {};
  if (words.size() == 2 && begins_as_number(words[0]) && same_word(words[1], "rib"))
    return fmt::format("write 'rib {}'", words[0] == "1" ? "1x1" : words[0]);
  struct Named {
    std::string_view name, knit;
  };
  constexpr std::array<Named, 6> names = {{{"cardigan", "full-cardigan"},
                                           {"stockinette", "jersey"},
                                           {"stocking", "jersey"},
                                           {"single-knit", "jersey"},
                                           {"singleknit", "jersey"},
                                           {"plain-knit", "jersey"}}};
  for (const Named& known : names)
    if (same_word(words[0], known.name)) return fmt::format("write '{}'", known.knit);
  for (const std::string_view chart : {"pique", "lacoste", "fleece", "ponte", "cable", "lace", "pointelle",
                                       "waffle", "terry", "tuck", "float", "miss"})
    if (same_word(words[0], chart))
      return "it is a chart of K, P, T and M behind 'knit' alone: see 'selvage explain chart'";
  return {};
}

bool closes_elsewhere(std::string_view kind, std::string_view word) {
  if (word == "}") return true;
  constexpr std::string_view end = "end";
  if (word.size() <= end.size() || !same_word(word.substr(0, end.size()), end)) return false;
  word.remove_prefix(end.size());
  if (word.front() == '-' || word.front() == '_') word.remove_prefix(1);
  return same_word(word, kind);
}

}  // namespace selvage::formats::txt
