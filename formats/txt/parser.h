// The grammar's skeleton: blocks of statements, the words that they know, the names that they define and use.
//
// A block is read by a Table: its statements' words, each with the function that reads the rest of the line.
// Recovery after an error: a misspelt word is read as the word that was meant, an unknown one is skipped with
// the block that it may open, a word of an outer block shows that an `end` is missing.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <unordered_map>
#include <vector>

#include "core/text_report.h"
#include "fabric/model.h"
#include "fabric/quantities.h"
#include "formats/txt/cursor.h"
#include "formats/txt/words.h"

namespace selvage::formats::txt {

class Parser;

enum class Times { at_most_once, once, any };

// `read` stands behind the word; it reads the rest of the line, and of the block that the statement opens.
// `instead_of`: the word of an earlier statement that this one is an alternative to; the two count as one.
template <class T>
struct Statement {
  std::string_view word;
  std::function<void(Parser&, T&, std::string_view word)> read;
  Times times = Times::at_most_once;
  std::string_view instead_of = {};
};

// What the skeleton needs to know of a table.
struct TableWords {
  std::vector<std::string_view> words;
  std::vector<std::size_t>
      slots;  // for each word its own index, or that of the one that it stands instead of
  std::vector<Times> times;
  bool has_rows = false;
  // The word that a line means which does not begin with one; empty: none. Null: there are no such lines.
  std::string_view (*word_of_line)(std::string_view line) = nullptr;
  bool rows_of_letters = false;  // rows may begin with a letter: all lines but words of open blocks are rows
};

template <class T>
struct Table : TableWords {
  using Row = void (*)(Parser&, T&);

  // `row` reads a line that does not begin with a letter; null: there are no such lines.
  explicit Table(std::vector<Statement<T>> list, Row read_row = nullptr, bool letters = false)
      : statements(std::move(list)), row(read_row) {
    has_rows = row != nullptr;
    rows_of_letters = letters;
    for (const Statement<T>& statement : statements) {
      std::size_t slot = words.size();
      for (std::size_t i = 0; i < words.size(); ++i)
        if (words[i] == statement.instead_of) slot = i;
      words.push_back(statement.word);
      slots.push_back(slot);
      times.push_back(statement.times);
    }
  }

  std::vector<Statement<T>> statements;
  Row row;
};

// An open block; the outermost one is the file.
struct Block {
  std::string_view kind;  // "thread"; empty: the file
  std::string_view name;  // of the thing; may be empty
  Spot opened;
  const TableWords* table = nullptr;
  const Block* outer = nullptr;
  std::array<int, 40> given{};  // by slot: the line of the statement; 0: not yet

  [[nodiscard]] std::string title() const;  // "thread 'tow'"
};

// The names of one kind of thing.
struct Names {
  std::string_view kind;                                 // "thread"
  std::unordered_map<std::string_view, int> lines = {};  // where each is defined
};

// What the notation of a yarn count says beside the count; 1 ply, 0 filaments: nothing.
struct CountParts {
  int plies = 1, filaments = 0;
  Spot spot{};
};

// A pitch as a text says it.
struct PitchText {
  Spot spot;
  std::string text;
  bool is_open = false;  // the text says that it is meant, however wide
};

class Parser : public Cursor {
 public:
  Parser(const Source& source, TextReport& messages) : Cursor(source, messages), report(messages) {}

  // Reads statements up to the block's `end`. False when that is missing.
  template <class T>
  bool read_block(std::string_view kind, std::string_view name, const Spot& opened, const Table<T>& table,
                  T& target);

  // The statement cannot be read: neither are the lines below it that stand further in, nor the `end` that
  // then follows.
  void skip_statement();

  void error(const Spot& spot, std::string text) { report.error(spot, std::move(text)); }

  // --- values: each reports what is wrong with it, calling it `what`, and gives nothing then
  // -----------------------
  // Of a quantity: one far outside of what exists is reported, too.
  std::optional<double> number_of(const fabric::Quantity& quantity, std::string_view what);
  std::optional<double> positive(std::string_view what, Measure measure = Measure::plain);
  std::optional<double> positive(std::string_view what, const fabric::Quantity& quantity);
  std::optional<double> not_negative(std::string_view what, const fabric::Quantity& quantity);
  void check(const fabric::Quantity& quantity, double value);
  std::optional<int> count(std::string_view what, int least = 1);
  std::optional<Vec3> point(std::string_view what);
  std::optional<Vec3> direction(std::string_view what);  // not zero
  // One of the words; a misspelt one is reported and read as the one that was meant.
  template <class T, std::size_t N>
  std::optional<T> choice(std::string_view what, const std::array<Word<T>, N>& words);
  // The word `word` itself.
  bool expect(std::string_view word);
  // Two counts joined by a sign: "2/1", "1x1".
  std::optional<std::array<int, 2>> pair(std::string_view what, char sign);
  // As many as there are, at most 1000.
  std::optional<std::vector<int>> counts(std::string_view what, char sign);

  // --- names
  // ----------------------------------------------------------------------------------------------------- The
  // name of a new thing; the same one twice is reported.
  std::optional<std::string_view> new_name(Names& names);
  // The name of a thing that is defined somewhere in the file; unknown ones are reported by
  // check_references().
  std::optional<std::string_view> reference(const Names& names);
  void check_references();
  // What `read` defines is known only to what it reads, which knows what stands round it as well.
  void with_own_names(const std::function<void()>& read);
  [[nodiscard]] int nesting() const { return nesting_; }  // of such calls

  // Of lists of threads that say how often each comes, over the whole text. False: with these there are more
  // than a text may have.
  static constexpr std::size_t most_listed = 1'000'000;
  bool take_listed(std::size_t times);

  TextReport& report;
  std::unordered_map<int, PitchText> pitches;  // of the systems of weaves, by their lines
  CountParts counted;                          // of the thread or yarn at hand
  std::span<const fabric::Setting> settings;   // of params, from outside
  fabric::Fabric fabric;
  Names threads{"thread"}, materials{"material"}, yarns{"yarn"}, pieces{"piece"}, outlines{"outline"},
      blocks{"block"};

 private:
  struct Reference {
    const Names* names;
    std::string_view name;
    Spot spot;
  };
  enum Step : int { row_step = -1, end_step = -2, missing_end_step = -3, skip_step = -4 };

  // The next statement of the block: the index of its word, which is taken, or a Step.
  int next_in_block(Block& block);
  int close(const Block& block);
  int note_given(Block& block, int index, std::string_view word);
  int unknown_word(const Block& block, std::string_view word);
  int missing_end(const Block& block);
  [[nodiscard]] bool at_row(const Block& block) const;
  // Reports; returns the word that was meant.
  std::string_view missing_choice(std::string_view what, std::string_view word,
                                  const std::vector<std::string_view>& known);

  const Block* block_ = nullptr;  // the innermost one that is open
  bool unwinding_ = false;        // a missing `end` was reported; those of the outer blocks are not
  std::vector<Reference> references_;
  int nesting_ = 0;
  std::size_t listed_ = 0;
};

template <class T>
bool Parser::read_block(std::string_view kind, std::string_view name, const Spot& opened,
                        const Table<T>& table, T& target) {
  Block block{kind, name, opened, &table, block_};
  block_ = &block;
  int step = 0;
  while ((step = next_in_block(block)) >= row_step) {
    if (step == row_step) {
      table.row(*this, target);
    } else {
      const Statement<T>& statement = table.statements[static_cast<std::size_t>(step)];
      statement.read(*this, target, statement.word);
      if constexpr (std::is_same_v<T, fabric::Fabric>)
        target.item_ends.resize(target.items.size(), this->statement().line);
    }
  }
  block_ = block.outer;
  return step == end_step;
}

template <class T, std::size_t N>
std::optional<T> Parser::choice(std::string_view what, const std::array<Word<T>, N>& words) {
  if (has_failed()) return std::nullopt;
  const std::string_view found = take_word();
  for (const Word<T>& word : words)
    if (same_word(word.text, found)) return word.value;
  std::vector<std::string_view> known(N);
  for (std::size_t i = 0; i < N; ++i) known[i] = words[i].text;
  const std::string_view meant = missing_choice(what, found, known);
  for (const Word<T>& word : words)
    if (word.text == meant) return word.value;
  return std::nullopt;
}

// --- statements of one value
// ------------------------------------------------------------------------------------------ The statement
// that is a value, as `read` reads it, which goes to `member`.
template <class T, class Value, class Read>
auto into(Value T::*member, const Read& read) {
  return [member, read](Parser& p, T& target, std::string_view) {
    const auto value = read(p);
    if (p.finish()) target.*member = *value;
  };
}
inline auto a_count(std::string_view what) {
  return [what](Parser& p) { return p.count(what); };
}
inline auto a_length(std::string_view what) {
  return [what](Parser& p) { return p.positive(what, Measure::length); };
}
inline auto a_positive(std::string_view what, const fabric::Quantity& quantity) {
  return [what, &quantity](Parser& p) { return p.positive(what, quantity); };
}
inline auto a_reference(const Names Parser::*names) {
  return [names](Parser& p) { return p.reference(p.*names); };
}
template <class Words>
auto one_of(std::string_view what, const Words& words) {
  return [what, &words](Parser& p) { return p.choice(what, words); };
}

}  // namespace selvage::formats::txt
