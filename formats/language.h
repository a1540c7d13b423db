// What the program teaches of a format that people write by hand: its words, and texts to begin with.
// `selvage new`, `selvage explain`, completion and editors' grammars are made of it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace selvage::formats {

// A statement. One word may have several, in different blocks.
struct Lesson {
  std::string_view word;
  std::string_view blocks;  // where it stands, by blanks: "thread yarn"; "file" is the outermost one
  std::string_view
      usage;  // as it is written, words in capitals for values; "... end" behind: it opens a block
  std::string_view meaning;   // one sentence or two, the ranges of its values in it
  std::string_view example;   // one line
  std::string_view unit{};    // a Measure's name, where a value has a unit
  std::string_view preset{};  // what holds without it; empty: nothing does

  [[nodiscard]] bool opens_block() const { return usage.ends_with("... end"); }
};

// A fixed word within a statement: one of its values, or what introduces one.
struct Value {
  std::string_view word;
  std::string_view statements;  // in which it stands, by blanks
  std::string_view meaning;
};

// What kind of number may carry which units.
struct Measures {
  std::string_view name;  // "length"
  std::string_view bare;  // the unit of a number without one
  std::vector<std::string_view> units;
};

// Words that stand for something known: fibres, colours, functions.
struct Known {
  std::string word;
  std::string meaning;
};

// A text to begin with.
struct Template {
  std::string_view kind;  // "denim"
  std::string_view text;  // its first line is a comment that says what it is

  [[nodiscard]] std::string_view title() const { return text.substr(2, text.find('\n') - 2); }
};

struct Language {
  std::string_view name;  // "Fabric TXT"
  std::span<const Lesson> lessons;
  std::span<const Value> values;
  std::span<const Template> templates;
  std::vector<Measures> measures;
  std::vector<Known> known;
  std::string (*grammar)(const Language& language);  // for editors, TextMate's form (JSON)
};

}  // namespace selvage::formats
