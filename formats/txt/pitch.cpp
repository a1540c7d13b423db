#include "formats/txt/pitch.h"

#include <algorithm>
#include <array>

#include "core/words.h"
#include "fabric/yarn_spec.h"
#include "formats/txt/words.h"
#include "yarn/section.h"

namespace selvage::formats::txt {

namespace {

constexpr std::array<std::string_view, 6> lengths = {"mm", "cm", "dm", "m", "in", "inch"};
constexpr std::string_view inch_sign = "\"";
constexpr std::array<std::string_view, 24> nouns = {
    "ends", "end",     "picks",  "pick",     "threads", "thread",  "yarns", "wales",
    "wale", "courses", "course", "stitches", "st",      "needles", "thr",   "thrs",
    "thds", "th",      "fd",     "fils",     "fil",     "yarn",    "e",     "p"};
// By their last letter: i an inch, c a centimetre.
constexpr std::array<std::string_view, 13> short_forms = {"epi", "ppi", "wpi",  "cpi",  "tpi",  "epc", "ppc",
                                                          "wpc", "cpc", "epcm", "ppcm", "cpcm", "wpcm"};

bool is_one_of(std::string_view word, const auto& words) {
  return std::any_of(words.begin(), words.end(),
                     [&](std::string_view known) { return same_word(known, word); });
}

// The number, name or bracketed expression in front.
std::size_t value_in_front(std::string_view text) {
  std::size_t i = 0;
  int depth = 0;
  const bool is_number = !text.empty() && !starts_name(text.front());
  for (; i < text.size(); ++i) {
    const char c = text[i];
    depth += (c == '(') - (c == ')');
    if (depth > 0 || c == ')') continue;
    const bool is_digit = (c >= '0' && c <= '9') || c == '.' || (i == 0 && c == '+');
    if (!is_digit && (is_number || !(starts_name(c)))) break;
  }
  return i;
}

std::string_view taken_word(std::string_view& rest) {
  rest = trimmed(rest);
  std::size_t size = 0;
  while (size < rest.size() && is_letter(rest[size])) ++size;
  const std::string_view word = rest.substr(0, size);
  rest.remove_prefix(size);
  return word;
}

}  // namespace

std::optional<std::string> pitch_in_own_form(std::string_view text) {
  const std::size_t size = value_in_front(text);
  if (size == 0) return std::nullopt;
  const std::string value(text.substr(0, size));
  std::string_view rest = text.substr(size);
  const std::string_view behind = trimmed(rest);
  if (behind.empty()) return std::nullopt;
  // 24/cm and 0.42mm are read as they are.
  const bool is_glued = behind.size() == rest.size();
  std::string_view word = taken_word(rest);
  if (is_one_of(word, short_forms) && trimmed(rest).empty())
    return value + (lower(word[2]) == 'i' ? "/in" : "/cm");
  if (is_one_of(word, lengths) && trimmed(rest).empty() && !is_glued) return value + std::string(word);
  for (const std::string_view inverse : {"-1", "^-1", "\xE2\x81\xBB\xC2\xB9"})  // 24 cm-1
    if (is_one_of(word, lengths) && rest == inverse) return value + "/" + std::string(word);
  const bool has_noun = is_one_of(word, nouns);
  if (has_noun) word = taken_word(rest);
  if (word.empty() && trimmed(rest).starts_with("/")) {
    if (is_glued && !has_noun && trimmed(rest).find_first_of(" \"") == std::string_view::npos)
      return std::nullopt;
    rest = trimmed(rest).substr(1);
  } else if (!same_word(word, "per")) {
    return std::nullopt;
  }
  rest = trimmed(rest);
  const std::size_t times = value_in_front(rest);  // per 10 cm
  std::string made =
      value + "/" + std::string(times > 0 && !starts_name(rest.front()) ? rest.substr(0, times) : "");
  if (times > 0 && !starts_name(rest.front())) rest.remove_prefix(times);
  if (trimmed(rest) == inch_sign) return made + "in";
  word = taken_word(rest);
  if (!trimmed(rest).empty() || !is_one_of(word, lengths)) return std::nullopt;
  return made + std::string(word);
}

std::optional<double> length_counted_on(std::string_view text) {
  const std::string own = pitch_in_own_form(text).value_or(std::string(text));
  const std::size_t slash = own.rfind('/');
  if (slash == std::string::npos || own.ends_with(')')) return std::nullopt;
  return own.find("in", slash) != std::string::npos ? 25.4 : 10.0;
}

double width_of_threads(std::span<const fabric::Fabric* const> inside,
                        const std::vector<std::string>& names) {
  double width = 0;
  for (const std::string& name : names) {
    const fabric::Thread* found = nullptr;
    for (const fabric::Fabric* const fabric : inside)
      if (const fabric::Thread* const own = fabric->find_thread(name)) found = own;
    if (found == nullptr) continue;
    fabric::Thread thread = *found;
    const fabric::Material* const material =
        thread.material ? inside.front()->find_material_anywhere(*thread.material) : nullptr;
    if (material != nullptr) {
      thread.material_density = material->density;
      thread.material_packing = material->packing;
    }
    if (const Result<yarn::Section> section = fabric::section_of(thread, inside.front()->units, false))
      width = std::max(width, yarn::nominal_size(*section).width);
  }
  return width;
}

}  // namespace selvage::formats::txt
