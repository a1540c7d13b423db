#include "formats/txt/trade_draft.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <span>

#include "core/text_report.h"
#include "core/words.h"
#include "formats/txt/words.h"

namespace selvage::formats::txt {

namespace {

using Form = Draft::Form;

constexpr int max_of_group = 50;  // yarns that go as one

// Denton and Daniels, Textile Terms and Definitions, under each name.
constexpr std::array<std::string_view, 20> plain_names = {
    "taffeta",  "poplin",      "tabby",   "calico",  "broadcloth", "muslin",  "voile",
    "canvas",   "percale",     "lawn",    "batiste", "cambric",    "organza", "chambray",
    "sheeting", "cheesecloth", "gingham", "ripstop", "1/1",        "1x1"};
// Equal groups both ways, where no numbers follow 2 x 2.
constexpr std::array<std::string_view, 4> group_names = {"hopsack", "panama", "matt", "celtic"};
struct TwillName {
  std::string_view name;
  int over = 0, under = 0;
  Hand hand = Hand::z;
};
constexpr std::array<TwillName, 5> twill_names = {{{"drill", 3, 1, Hand::s},
                                                   {"denim", 3, 1, Hand::z},
                                                   {"jean", 2, 1, Hand::z},
                                                   {"serge", 2, 2, Hand::z},
                                                   {"batavia", 2, 2, Hand::z}}};

// A and B of `AxB`, `A/B`.
std::optional<std::array<int, 2>> pair_of(std::string_view text, char sign) {
  std::array<int, 2> pair{};
  const auto [first, failure] = std::from_chars(text.data(), text.data() + text.size(), pair[0]);
  const char* const end = text.data() + text.size();
  if (failure != std::errc{} || first == end || lower(*first) != sign) return std::nullopt;
  const auto [second, other] = std::from_chars(first + 1, end, pair[1]);
  if (other != std::errc{} || second != end || pair[0] < 1 || pair[1] < 1) return std::nullopt;
  return pair;
}

// Plain weave of groups: so many ends by so many picks go as one.
void make_groups(Draft& draft, int ends, int picks) {
  draft.form = Form::rows;
  const std::string one(static_cast<std::size_t>(ends), '1'), other(static_cast<std::size_t>(ends), '0');
  draft.rows.insert(draft.rows.end(), static_cast<std::size_t>(picks), one + other);
  draft.rows.insert(draft.rows.end(), static_cast<std::size_t>(picks), other + one);
}

std::string make_twill(Draft& draft, int over, int under, Hand hand) {
  draft.form = Form::twill;
  draft.a = over;
  draft.b = under;
  draft.hand = hand;
  return fmt::format("twill {}/{} {}", over, under, word_of(hand_words, hand));
}

bool is_any_of(std::string_view word, std::span<const std::string_view> names) {
  return std::any_of(names.begin(), names.end(), [&](auto name) { return same_word(word, name); });
}

// `5HS`, `8-harness`, `8 shaft`.
std::optional<int> harness_satin(std::string_view word) {
  int shafts = 0;
  const auto [stop, failure] = std::from_chars(word.data(), word.data() + word.size(), shafts);
  if (failure != std::errc{}) return std::nullopt;
  std::string_view name(stop, static_cast<std::size_t>(word.data() + word.size() - stop));
  if (name.starts_with("-") || name.starts_with(" ")) name.remove_prefix(1);
  constexpr std::array<std::string_view, 6> names = {"HS", "harness", "H", "shaft", "end", "heald"};
  const bool is_satin = is_any_of(name, names);
  return is_satin && shafts >= 4 && shafts <= 100 ? std::optional(shafts) : std::nullopt;
}

std::string make_satin(Draft& draft, int shafts) {
  draft.form = Form::satin;
  draft.a = shafts;
  draft.b = 0;
  return fmt::format("satin {} (weft-faced, as `satin` is without a word)", shafts);
}

// The direction of a twill's lines: a right-hand twill runs up to the right, as the stroke of a Z.
std::optional<Hand> hand_named(std::string_view word) {
  for (const auto& hand : hand_words)
    if (same_word(word, hand.text)) return hand.value;
  for (const std::string_view right : {"right", "right-hand", "rh", "rht"})
    if (same_word(word, right)) return Hand::z;
  for (const std::string_view left : {"left", "left-hand", "lh", "lht"})
    if (same_word(word, left)) return Hand::s;
  return std::nullopt;
}

// `twill 3/1 left`, `3/1 S`, `left-hand twill 2/1`; `twill 3/1 Z` is the language's own.
std::optional<std::string> twill_with_hand(const std::vector<std::string_view>& words, Draft& draft) {
  const bool is_own = words.size() == 3 && same_word(words[0], "twill") && words[2].size() == 1;
  if (is_own) return std::nullopt;
  std::optional<Hand> hand;
  std::optional<std::array<int, 2>> numbers;
  bool has_name = false;
  for (const std::string_view word : words) {
    if (same_word(word, "twill") && !has_name)
      has_name = true;
    else if (const auto found = hand_named(word); found && !hand)
      hand = found;
    else if (const auto pair = pair_of(word, '/'); pair && !numbers)
      numbers = pair;
    else
      return std::nullopt;
  }
  if (!hand || !numbers) return std::nullopt;
  return make_twill(draft, (*numbers)[0], (*numbers)[1], *hand);
}

std::string groups_text(const std::array<int, 2>& pair) {
  return fmt::format("{} ends x {} picks as one", pair[0], pair[1]);
}

// `drill 2/1`, `3/1 denim`, `oxford 2x1`, `matt 3/3`, `sateen 5`: a name, and the numbers that it may have.
std::optional<std::string> named_with_numbers(std::string_view first, std::string_view last, Draft& draft) {
  const bool is_name_first = is_letter(first.front());
  const std::string_view name = is_name_first ? first : last, numbers = is_name_first ? last : first;
  for (const TwillName& twill : twill_names)
    if (same_word(name, twill.name))
      if (const auto pair = pair_of(numbers, '/'))
        return make_twill(draft, (*pair)[0], (*pair)[1], twill.hand);
  auto pair = pair_of(numbers, 'x');
  if (!pair) pair = pair_of(numbers, '/');
  if (pair && std::max((*pair)[0], (*pair)[1]) <= max_of_group &&
      (same_word(name, "oxford") || (is_any_of(name, group_names) && (*pair)[0] == (*pair)[1])))
    return make_groups(draft, (*pair)[0], (*pair)[1]), groups_text(*pair);
  int shafts = 0;
  const char* const end = numbers.data() + numbers.size();
  const auto [stop, failure] = std::from_chars(numbers.data(), end, shafts);
  if (!same_word(name, "sateen") || failure != std::errc{} || stop != end || shafts < 4 || shafts > 100)
    return std::nullopt;
  draft.form = Form::satin;
  draft.a = shafts;
  draft.b = 0;
  return fmt::format("satin {} weft-faced", shafts);
}

}  // namespace

std::optional<std::string> draft_of_trade(std::string_view text, Draft& draft) {
  std::vector<std::string_view> words = words_of(text);
  if (words.size() > 1 && same_word(words.back(), "weave")) words.pop_back();
  if (auto understood = twill_with_hand(words, draft)) return understood;
  // `8 harness satin`, `8 shaft`.
  if (words.size() > 1)
    if (const auto shafts = harness_satin(fmt::format("{} {}", words[0], words[1]));
        shafts && (words.size() == 2 || (words.size() == 3 && same_word(words[2], "satin"))))
      return make_satin(draft, *shafts);
  if (words.empty() || words.size() > 2) return std::nullopt;
  const std::string_view first = words.front(), last = words.back();
  const auto is = [](std::string_view word, std::string_view name) { return same_word(word, name); };
  if (words.size() == 2)
    if (auto understood = named_with_numbers(first, last, draft)) return understood;
  if (words.size() == 1) {
    for (const std::string_view name : plain_names)
      if (is(first, name)) return draft.form = Form::plain, std::string();
    for (const TwillName& twill : twill_names)
      if (is(first, twill.name)) return make_twill(draft, twill.over, twill.under, twill.hand);
    if (is(first, "oxford")) return make_groups(draft, 2, 1), groups_text({2, 1});
    if (is_any_of(first, group_names)) return make_groups(draft, 2, 2), groups_text({2, 2});
    if (const auto pair = pair_of(first, '/')) return make_twill(draft, (*pair)[0], (*pair)[1], Hand::z);
  }
  // `twill 2x2`, `2x2 twill`.
  const bool twill_first = is(first, "twill"), twill_last = is(last, "twill");
  if (words.size() == 2 && twill_first != twill_last)
    if (const auto pair = pair_of(twill_first ? last : first, 'x')) {
      make_twill(draft, (*pair)[0], (*pair)[1], Hand::z);
      return std::string();
    }
  if (words.size() == 2 && twill_last)
    if (const auto pair = pair_of(first, '/'))
      return make_twill(draft, (*pair)[0], (*pair)[1], Hand::z), std::string();
  // `basket 2x1`, `2x1`, `2x1 basket`.
  const bool is_basket = words.size() == 1 || is(first, "basket") != is(last, "basket");
  if (is_basket)
    if (const auto pair = pair_of(words.size() == 2 && is(first, "basket") ? last : first, 'x')) {
      if ((*pair)[0] > max_of_group || (*pair)[1] > max_of_group) return std::nullopt;
      make_groups(draft, (*pair)[0], (*pair)[1]);
      return words.size() == 2
                 ? std::string()
                 : groups_text(*pair) + fmt::format("; a twill is `twill {}/{}`", (*pair)[0], (*pair)[1]);
    }
  // `5HS`, `5HS satin`, `crowfoot`.
  const auto shafts = is(first, "crowfoot") ? std::optional(4) : harness_satin(first);
  if (shafts && (words.size() == 1 || is(last, "satin"))) return make_satin(draft, *shafts);
  return std::nullopt;
}

std::string instead_of_draft(std::string_view text) {
  struct Name {
    std::string_view name, draft;
  };
  // The weave that each cloth commonly has.
  constexpr std::array<Name, 8> names = {{{"gauze", "leno"},
                                          {"leinwand", "plain"},
                                          {"linen", "plain"},
                                          {"gabardine", "twill 2/2"},
                                          {"broken", "satin 4"},
                                          {"repp", "plain"},
                                          {"rep", "plain"},
                                          {"rib", "basket 1x2"}}};
  constexpr std::array<std::string_view, 14> own = {
      "herringbone", "chevron", "honeycomb", "waffle",  "crepe",    "bedford",  "dobby",
      "jacquard",    "huck",    "diamond",   "pointed", "whipcord", "barathea", "moss"};
  const std::vector<std::string_view> words = words_of(text);
  if (words.empty()) return {};
  for (const Name& known : names)
    if (same_word(known.name, words.front())) return fmt::format("write '{}'", known.draft);
  if (is_any_of(words.front(), own))
    return "its rows of 0 and 1 stand below 'draft', and 'end' behind them, or in a file: `draft file NAME`; "
           "see "
           "'selvage explain draft'";
  return {};
}

std::string_view near_draft_of_trade(std::string_view word) {
  std::vector<std::string_view> names;
  names.reserve(draft_words.size() + 2 + group_names.size() + plain_names.size() + twill_names.size());
  for (const auto& draft : draft_words) names.push_back(draft.text);
  const std::size_t own = names.size();
  if (same_word(word, "sateen")) return "sateen 5";
  names.insert(names.end(), {"oxford", "crowfoot"});
  names.insert(names.end(), group_names.begin(), group_names.end());
  names.insert(names.end(), plain_names.begin(), plain_names.end());
  for (const TwillName& twill : twill_names) names.push_back(twill.name);
  const std::string_view near = near_word(word, names);
  return std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(own), near) ==
                 names.begin() + static_cast<std::ptrdiff_t>(own)
             ? near
             : std::string_view{};
}

}  // namespace selvage::formats::txt
