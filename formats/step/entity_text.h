// The text of a Part 21 file (ISO 10303-21), entity by entity, straight to its OutputFile: little is kept.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/text_queue.h"
#include "core/vec.h"

namespace selvage::formats::step {

// The number of an entity: #12.
struct Id {
  std::size_t number = 0;
};

// Attributes of put() beside Id, int and double, which are written as Part 21 has them.
struct Quoted {  // a string: UTF-8, or Latin-1 where it is none
  std::string_view text;
};
struct Flag {
  bool is_true;
};
struct Measure {  // LENGTH_MEASURE(25.4)
  std::string_view type;
  double value;
};

// A list of lists, each on lines of its own: ((#1,#2),(#3,#4)).
struct Net {
  std::vector<Id> ids;  // row by row
  std::size_t rows;     // at least 1
};

// How lines are filled: where one may be broken, it is before what no longer fits.
class Filling {
 public:
  // Leaves room for the brackets that may follow the last token.
  static constexpr std::size_t filled_to = 72;

  // `out` takes string views one after the other (append).
  template <class Out>
  void token(Out& out, std::string_view token) {
    if (token.empty()) return;
    if (column_ + token.size() > filled_to && (before_ == ',' || before_ == '(' || before_ == ' ')) {
      out.append("\n");
      column_ = 0;
    }
    out.append(token);
    before_ = token.back();
    column_ = before_ == '\n' ? 0 : column_ + token.size();
  }

 private:
  std::size_t column_ = 0;
  char before_ = '\n';  // the last character
};

// `text` as a Part 21 string with its quotes. What is not ASCII is written as \X2\00FC\X0\ (\X4\ beyond 16
// bits), and so is a backslash, which some readers take for the beginning of a code even where it is doubled.
std::string encoded(std::string_view text);

// Lines are filled to 80 columns at most, but for strings, which are not broken. A number is the shortest
// that reads back to the same bits, with a decimal point. The first failure of the file is kept for finish().
class EntityText {
 public:
  explicit EntityText(OutputFile& output, int threads = 1) : queue_(output, threads) {}

  // A number for an entity that is written later.
  Id reserve() { return {++last_}; }

  // #12 = NAME(first,second,...);
  template <class... Attributes>
  Id put(std::string_view name, const Attributes&... attributes) {
    return put_as(reserve(), name, attributes...);
  }
  template <class... Attributes>
  Id put_as(Id id, std::string_view name, const Attributes&... attributes) {
    begin(id);
    part(name, attributes...);
    end();
    return id;
  }

  struct Point {
    Id id;
    Vec3 at;
  };
  // CARTESIAN_POINTs without a name, of numbers reserved for them. Many are formatted by the threads.
  void put_points(std::vector<Point> points);

  // The same in pieces: begin, parts (more than one: between brackets, of a complex entity), end.
  void begin(Id id);
  void end();
  template <class... Attributes>
  void part(std::string_view name, const Attributes&... attributes) {
    token(name);
    token("(");
    [[maybe_unused]] bool is_first = true;
    [[maybe_unused]] const auto one = [&](const auto& attribute) {
      if (!is_first) token(",");
      is_first = false;
      value(attribute);
    };
    (one(attributes), ...);
    token(")");
  }

  // As it stands: it must not hold what a line may be broken in.
  void token(std::string_view token) { filling_.token(text_, token); }
  void value(std::string_view word) { token(word); }
  void value(const char* word) { token(word); }
  void value(Id id);
  void value(int number);
  void value(double number);
  void value(Flag flag) { token(flag.is_true ? ".T." : ".F."); }
  void value(const Quoted& quoted) { token(encoded(quoted.text)); }
  void value(const Measure& measure) { part(measure.type, measure.value); }
  // A large one is formatted by the threads.
  void value(const Net& net);
  // A list: (first,second,...).
  template <class Value>
  void value(std::span<const Value> list) {
    token("(");
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (i > 0) token(",");
      value(list[i]);
    }
    token(")");
  }
  template <class Value>
  void value(const std::vector<Value>& list) {
    value(std::span<const Value>(list));
  }
  template <class Value, std::size_t count>
  void value(const std::array<Value, count>& list) {
    value(std::span<const Value>(list));
  }

  // What was written so far is all: the rest goes to the file. Error (io): the file refused it.
  Status finish();

 private:
  void hand_over();

  std::string text_;  // that is not in the queue yet
  TextQueue queue_;
  std::size_t last_ = 0;
  Filling filling_;
};

}  // namespace selvage::formats::step
