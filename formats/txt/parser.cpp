#include "formats/txt/parser.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <limits>

#include "core/words.h"
#include "fabric/fibres.h"
#include "formats/txt/count.h"
#include "formats/txt/slip.h"

namespace selvage::formats::txt {

namespace {

int find_word(const std::vector<std::string_view>& words, std::string_view word) {
  const auto found =
      std::find_if(words.begin(), words.end(), [&](auto known) { return same_word(known, word); });
  return found == words.end() ? -1 : static_cast<int>(found - words.begin());
}

// Words of the trades for what a statement is called here.
constexpr std::array<Word<std::string_view>, 12> trade_words{{{"ends", "warp"},
                                                              {"lapping", "bar"},
                                                              {"draft", "pattern"},
                                                              {"picks", "weft"},
                                                              {"filling", "fill"},
                                                              {"woof", "weft"},
                                                              {"woven", "weave"},
                                                              {"weaving", "weave"},
                                                              {"knitted", "knit"},
                                                              {"braided", "braid"},
                                                              {"fibre", "material"},
                                                              {"fiber", "material"}}};

// The one of the known words that is meant; empty: none is near.
std::string_view meant_word(std::string_view word, const std::vector<std::string_view>& known) {
  for (const auto& trade : trade_words)
    if (same_word(trade.text, word) && find_word(known, trade.value) >= 0) return trade.value;
  return near_word(word, known);
}

// Numbers that are joined by another sign: what to write.
std::string joined_by(std::string_view word, char sign) {
  std::string now(word);
  for (char& c : now)
    if (std::string_view("/:-x*\\").find(lower(c)) != std::string_view::npos) c = sign;
  const bool is_cured = now != word && now.front() != sign && now.back() != sign &&
                        now.find_first_not_of(std::string("0123456789") + sign) == std::string::npos;
  return is_cured ? fmt::format(": write '{}'", now) : std::string();
}

}  // namespace

std::string Block::title() const {
  return name.empty() ? fmt::format("'{}'", kind) : fmt::format("{} {}", kind, in_quotes(name));
}

// --- blocks
// ---------------------------------------------------------------------------------------------------------

bool Parser::at_row(const Block& block) const {
  if (!starts_name(first_character())) return true;
  const std::string_view word = statement_word();
  if (scope().begins_with_param(word)) return true;
  if (word.find('(') != std::string_view::npos) return true;  // a function
  if (same_word(word, "nan") || same_word(word, "inf") || same_word(word, "infinity")) return true;
  if (!block.table->rows_of_letters || same_word(word, "end")) return false;
  for (const Block* open = &block; open != nullptr; open = open->outer)
    if (find_word(open->table->words, word) >= 0) return false;
  return true;
}

int Parser::next_in_block(Block& block) {
  while (next_statement()) {
    if (block.table->has_rows && at_row(block)) {
      unwinding_ = false;
      return row_step;
    }
    std::string_view word = peek_word();
    int step = find_word(block.table->words, word);
    bool is_in_line = false;  // the line means a word that it does not begin with
    if (step < 0 && block.table->word_of_line != nullptr) {
      const std::string_view meant = block.table->word_of_line(peek_rest());
      step = find_word(block.table->words, meant);
      is_in_line = step >= 0;
      if (is_in_line) word = meant;
    }
    if (step < 0) step = same_word(word, "end") ? static_cast<int>(end_step) : unknown_word(block, word);
    if (step >= 0) step = note_given(block, step, word);
    if (step == missing_end_step) return missing_end(block);
    if (step == skip_step) continue;
    unwinding_ = false;
    if (!is_in_line) take_word();
    if (step >= 0) return step;
    if (close(block) == end_step) return end_step;
  }
  return block.outer != nullptr ? missing_end(block) : static_cast<int>(end_step);
}

// Behind the word `end`.
int Parser::close(const Block& block) {
  const Spot spot = last();
  finish();
  if (block.outer == nullptr) {
    error(spot, "an 'end' without a block that it closes");
    return skip_step;
  }
  const TableWords& table = *block.table;
  for (std::size_t i = 0; i < table.words.size(); ++i) {
    if (table.times[i] != Times::once || table.slots[i] != i || block.given[i] != 0) continue;
    std::string words = fmt::format("'{}'", table.words[i]);
    for (std::size_t j = i + 1; j < table.words.size(); ++j)
      if (table.slots[j] == i) words += fmt::format(" or '{}'", table.words[j]);
    error(spot, fmt::format("{} ends without its {}{}", block.title(), words,
                            block.kind == "yarn" ? "; what cloths are made of is a 'thread'" : ""));
  }
  return end_step;
}

// A statement that may stand once only; `index` is its word.
int Parser::note_given(Block& block, int index, std::string_view word) {
  const auto i = static_cast<std::size_t>(index);
  const std::size_t slot = block.table->slots[i];
  if (block.table->times[i] == Times::any) return index;
  int& line = block.given[slot];
  if (line == 0) {
    line = statement().line;
    return index;
  }
  for (const Block* outer = block.outer; outer != nullptr; outer = outer->outer)
    if (find_word(outer->table->words, word) >= 0) return missing_end_step;
  const std::string there = block.outer == nullptr ? "this file" : block.title();
  std::vector<std::string_view> words;
  for (std::size_t j = 0; j < block.table->words.size(); ++j)
    if (block.table->slots[j] == slot) words.push_back(block.table->words[j]);
  error(statement(),
        fmt::format("{} is given twice in {}; first on line {}{}", in_quotes(word), there, line,
                    words.size() > 1 ? fmt::format(" (of {} one may stand)", fmt::join(words, ", "))
                                     : std::string()));
  return index;
}

int Parser::unknown_word(const Block& block, std::string_view word) {
  const bool is_text = text_prefix(peek_rest()) == peek_rest().size();
  if (const std::optional<std::string> line =
          is_text ? meant_line(block.kind, peek_rest(), block.table->words) : std::nullopt) {
    error(statement(), fmt::format("{} is not a statement of {}: write '{}'", in_quotes(peek_rest()),
                                   block.outer != nullptr ? block.title() : "a fabric", *line));
    skip_statement();
    return skip_step;
  }
  if (block.outer != nullptr && closes_elsewhere(block.kind, word)) {
    error(statement(), fmt::format("{} is closed by the word 'end': write 'end'", block.title()));
    return end_step;
  }
  for (const Block* outer = block.outer; outer != nullptr; outer = outer->outer)
    if (find_word(outer->table->words, word) >= 0) return missing_end_step;
  if (text_prefix(word) != word.size()) {
    finish();  // says that this is no text, and stops
    return skip_step;
  }
  std::vector<std::string_view> known = block.table->words;
  if (block.outer != nullptr) known.emplace_back("end");
  if (const std::size_t sign = word.find_first_of("=:");
      sign < word.size() - 1 && find_word(known, word.substr(0, sign)) >= 0) {
    const std::string_view rest = peek_rest();
    error(statement(), fmt::format("between a word and its value stands a blank: write '{} {}'",
                                   word.substr(0, sign), readable(trimmed(rest.substr(sign + 1)))));
    skip_statement();
    return skip_step;
  }
  const std::string_view near = meant_word(word, known);
  if (block.table->word_of_line != nullptr && word.front() >= '0' && word.front() <= '9') {
    error(statement(),
          fmt::format("a yarn count begins with its system, tex, dtex, denier, Nm or Ne: write 'dtex {}'",
                      shortened(peek_rest())));
    skip_statement();
    return skip_step;
  }
  if (block.table->word_of_line != nullptr && is_title_of_count(word)) {
    const std::string number = readable(trimmed(peek_rest().substr(word.size())));
    error(statement(), fmt::format("a yarn count says its system: write 'Ne {0}', or 'Nm {0}', 'tex {0}', "
                                   "'dtex {0}' or 'denier {0}', whichever it is",
                                   number));
    skip_statement();
    return skip_step;
  }
  std::string what = fmt::format("unknown word {}", in_quotes(word));
  if (block.outer != nullptr) what += fmt::format(" in {}", block.title());
  if (block.table->has_rows) what += " where a row of numbers or 'end' is expected";
  what += near.empty() ? fmt::format("; known: {}", fmt::join(known, ", "))
                       : fmt::format("; did you mean '{}'?", near);
  error(statement(), what);
  if (same_word(near, "end")) return end_step;
  if (!near.empty()) return find_word(known, near);
  skip_statement();
  return skip_step;
}

void Parser::skip_statement() {
  const int column = statement().column;
  bool skipped = false;
  while (next_statement()) {
    if (statement().column > column) {
      skipped = true;
      continue;
    }
    if (!skipped || statement().column != column || !same_word(peek_word(), "end")) reread();
    return;
  }
}

int Parser::missing_end(const Block& block) {
  if (!unwinding_ && !is_stopped()) {
    const std::string_view next = peek_word();
    const std::string where =
        next.empty() ? "at the end of the file" : fmt::format("before {}", in_quotes(next));
    error(statement(), fmt::format("'end' is missing: {}, opened on line {}, is still open {}", block.title(),
                                   block.opened.line, where));
  }
  unwinding_ = true;
  reread();
  return missing_end_step;
}

// --- values
// ---------------------------------------------------------------------------------------------------------

std::optional<double> Parser::number_of(const fabric::Quantity& quantity, std::string_view what) {
  const std::optional<double> value = number(what, quantity.measure);
  if (value) check(quantity, *value);
  return value;
}

std::optional<double> Parser::positive(std::string_view what, Measure measure) {
  const std::optional<double> value = number(what, measure);
  if (value && !(*value > 0.0)) return fail(last(), fmt::format("{} has to be larger than 0", what));
  return value;
}

std::optional<double> Parser::positive(std::string_view what, const fabric::Quantity& quantity) {
  const std::optional<double> value = positive(what, quantity.measure);
  if (value) check(quantity, *value);
  return value;
}

std::optional<double> Parser::not_negative(std::string_view what, const fabric::Quantity& quantity) {
  const std::optional<double> value = number(what, quantity.measure);
  if (value && !(*value >= 0.0)) return fail(last(), fmt::format("{} has to be 0 or larger", what));
  if (value) check(quantity, *value);
  return value;
}

void Parser::check(const fabric::Quantity& quantity, double value) {
  const std::string odd = fabric::oddity(quantity, value);
  if (!odd.empty()) error(last(), odd);
}

std::optional<int> Parser::count(std::string_view what, int least) {
  return integer(what, least, std::numeric_limits<int>::max());
}

std::optional<Vec3> Parser::point(std::string_view what) {
  Vec3 point;
  for (double& x : point) x = number(what, Measure::length).value_or(0.0);
  return has_failed() ? std::nullopt : std::optional(point);
}

std::optional<Vec3> Parser::direction(std::string_view what) {
  const Spot spot = here();
  std::optional<Vec3> vector = point(what);
  if (!vector || *vector != Vec3::Zero()) return vector;
  return fail(spot, fmt::format("{}: 0 0 0 is no direction", what));
}

std::string_view Parser::missing_choice(std::string_view what, std::string_view word,
                                        const std::vector<std::string_view>& known) {
  if (word.empty()) {
    fail(here(), fmt::format("{} is missing: {}", what, fmt::join(known, ", ")));
    return {};
  }
  const std::string meant = did_you_mean(word, known);
  fail(last(), fmt::format("unknown {} {}{}", what, in_quotes(word),
                           meant.empty() ? fmt::format("; known: {}", fmt::join(known, ", ")) : meant));
  if (!meant.empty()) go_on();
  return near_word(word, known);
}

bool Parser::expect(std::string_view word) {
  if (has_failed()) return false;
  const Spot spot = here();
  const std::string_view found = take_word();
  if (!same_word(found, word))
    fail(spot, found.empty() ? fmt::format("the word '{}' is missing", word)
                             : fmt::format("the word '{}' is expected, found {}", word, in_quotes(found)));
  return !has_failed();
}

std::optional<std::vector<int>> Parser::counts(std::string_view what, char sign) {
  if (has_failed()) return std::nullopt;
  const Spot spot = here();
  const std::string_view word = take_word();
  if (word.empty())
    return fail(spot,
                fmt::format("{} is missing: whole numbers joined by '{}', as in 2{}1", what, sign, sign));
  std::vector<int> values;
  constexpr std::size_t most = 1000;
  for (const std::string_view part : split(word, sign)) {
    int value = 0;
    const auto [stop, failure] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (failure != std::errc{} || stop != part.data() + part.size() || value < 1 || values.size() == most)
      return fail(spot, fmt::format("{}: whole numbers joined by '{}' are expected, as in 2{}1, found {}{}",
                                    what, sign, sign, in_quotes(word), joined_by(word, sign)));
    values.push_back(value);
  }
  return values;
}

std::optional<std::array<int, 2>> Parser::pair(std::string_view what, char sign) {
  if (has_failed()) return std::nullopt;
  const Spot spot = here();
  const std::string_view word = take_word();
  std::array<int, 2> values{};
  const char* p = word.data();
  const char* const end = p + word.size();
  bool good = true;
  for (std::size_t i = 0; i < 2 && good; ++i) {
    const auto [stop, failure] = std::from_chars(p, end, values[i]);
    good = failure == std::errc{} && values[i] >= 1 &&
           (i == 1 ? stop == end : stop != end && lower(*stop) == sign);
    p = stop + (i == 0 && good ? 1 : 0);
  }
  if (good) return values;
  if (word.empty())
    return fail(spot, fmt::format("{} is missing: two whole numbers, as in 2{}1", what, sign));
  return fail(spot, fmt::format("{}: two whole numbers joined by '{}' are expected, as in 2{}1, found {}{}",
                                what, sign, sign, in_quotes(word), joined_by(word, sign)));
}

// --- names
// ----------------------------------------------------------------------------------------------------------

std::optional<std::string_view> Parser::new_name(Names& names) {
  const std::optional<std::string_view> found = name(fmt::format("the {}'s name", names.kind));
  if (!found) return found;
  const auto [entry, is_new] = names.lines.emplace(*found, last().line);
  if (!is_new)
    error(last(), fmt::format("the {} name {} is used twice; first on line {}", names.kind, in_quotes(*found),
                              entry->second));
  return found;
}

std::optional<std::string_view> Parser::reference(const Names& names) {
  // 8 24/cm
  if (const std::string_view rest = peek_rest(); !has_failed() && !rest.empty() && rest.front() >= '0' &&
                                                 rest.front() <= '9' && names.lines.size() == 1) {
    const std::string_view known = names.lines.begin()->first;
    const std::vector<std::string_view> words = words_of(rest);
    const bool is_behind = words.size() > 1 && words[1] == known;
    const std::string text(is_behind ? rest.substr(static_cast<std::size_t>(words[1].data() - rest.data()))
                                     : rest);
    return fail(here(), is_behind
                            ? fmt::format("the {}'s name stands here: write '{}'", names.kind, readable(text))
                            : fmt::format("the {}'s name is missing: write '{} {}'", names.kind, known,
                                          readable(text)));
  }
  const std::optional<std::string_view> found = name(fmt::format("the {}'s name", names.kind));
  if (found && !names.lines.contains(*found)) references_.push_back({&names, *found, last()});
  return found;
}

void Parser::with_own_names(const std::function<void()>& read) {
  const std::array<Names*, 6> kinds = {&threads, &materials, &yarns, &pieces, &outlines, &blocks};
  std::array<decltype(Names::lines), 6> around;
  for (std::size_t i = 0; i < kinds.size(); ++i) around[i].swap(kinds[i]->lines);
  std::vector<Reference> references;
  references.swap(references_);
  ++nesting_;
  read();
  --nesting_;
  // The yarns of a block are its own: those of an edit are looked for when it is built.
  for (const Reference& reference : references_)
    if (reference.names != &yarns && !reference.names->lines.contains(reference.name))
      references.push_back(reference);
  references_ = std::move(references);
  for (std::size_t i = 0; i < kinds.size(); ++i) around[i].swap(kinds[i]->lines);
}

bool Parser::take_listed(std::size_t times) {
  if (times > most_listed - listed_) return false;
  listed_ += times;
  return true;
}

void Parser::check_references() {
  if (is_stopped()) return;  // what was not read may define them
  // The yarns of a construction get their names when it is built.
  const bool are_yarns_known =
      std::all_of(fabric.items.begin(), fabric.items.end(), [](const fabric::Item& item) {
        return std::holds_alternative<fabric::Yarn>(item) || std::holds_alternative<fabric::Piece>(item);
      });
  for (const Reference& reference : references_) {
    const Names& names = *reference.names;
    if (names.lines.contains(reference.name) || (&names == &yarns && !are_yarns_known)) continue;
    if (&names == &materials && fabric::find_fibre(reference.name) != nullptr) continue;
    if (is_stopped()) return;
    std::vector<std::string_view> known;
    for (const auto& [name, line] : names.lines) known.push_back(name);
    if (&names == &materials)
      for (const fabric::Fibre& fibre : fabric::all_fibres()) known.push_back(fibre.material.name);
    std::sort(known.begin(), known.end());
    std::string hint = known.empty() ? fmt::format("; this file defines no {}", names.kind)
                                     : did_you_mean(reference.name, known);
    if (hint.empty() && &names == &materials)
      hint = fmt::format("; known: {} (others have a block 'material {}')", fmt::join(known, ", "),
                         is_identifier(reference.name) ? reference.name : "NAME");
    error(reference.spot, fmt::format("unknown {} {}{}", names.kind, in_quotes(reference.name), hint));
  }
}

}  // namespace selvage::formats::txt
