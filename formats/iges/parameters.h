// The parameters of one entity, or of the global section: free format, read one after the other.
#pragma once

#include <cstdint>
#include <forward_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/iges/lines.h"

namespace selvage::formats::iges {

// What parts the values of a file: global parameters 1 and 2.
struct Delimiters {
  char parameter = ',';
  char record = ';';
};

inline constexpr std::int64_t most_pointer = 9'999'999;

// A cursor over the lines `first` to `last` (numbers in the section). Cheap to copy; nothing is kept but
// views of the file, so that any number of threads may have one each.
//
// After the record delimiter every value is defaulted, as the standard has it: integer() and real() give
// their default, text() an empty string. reals() and count() do not put up with it.
//
// The first error stays (ok(), failure()) and all values after it are the defaults. Values: a number may have
// blanks on both sides; an integer may be written as a real without a fraction, a real as an integer;
// exponents have an E or a D; a string is nHtext of any characters, over as many lines as it needs.
class Parameters {
 public:
  struct Failure {
    Spot spot;
    std::string text;
    bool unsupported =
        false;  // well formed, but not something that this version does: not an error of the file
  };

  Parameters(const Lines& lines, Section section, int first, int last, Delimiters delimiters);

  std::int64_t integer(std::int64_t otherwise = 0);
  double real(double otherwise = 0);
  bool logical(bool otherwise = false) { return integer(otherwise ? 1 : 0) != 0; }
  // A directory pointer as it stands: 0 for none, possibly negative or nonsense; File::entity() judges it.
  int pointer();
  // Where the count is wrong without a doubt (the line ends with the only delimiter behind the H) the string
  // is what stands before that delimiter, and flaw() tells.
  std::string text();
  void skip();  // any value
  // For who takes values of any kind: does a string stand next, which text() takes? If not, token() gives the
  // characters of the value as they stand, empty where it is defaulted. A number that runs over the end of
  // its line, which every other function refuses, is put together in `joined` (else left empty).
  bool is_string();
  std::string_view token(std::string& joined);

  // `count` reals into `out`; a defaulted one is 0. An error where the record ends before.
  bool reals(double* out, std::size_t count);
  // How many things follow, each of at least `fields_each` values: an error where it is negative, or more
  // than there is room for. `what` for the message: "control points". 0 after an error.
  std::size_t count(std::string_view what, std::size_t fields_each = 1);

  // A count, and so many directory pointers; an error where the record ends before.
  std::vector<int> pointers(std::string_view what);

  // An upper bound of the number of values left: of what a count in the file may claim.
  [[nodiscard]] std::size_t room() const;
  // Has the record delimiter been passed?
  [[nodiscard]] bool at_end() const { return done_; }

  [[nodiscard]] const Delimiters& delimiters() const { return delimiters_; }
  [[nodiscard]] bool ok() const { return !failure_; }
  [[nodiscard]] const std::optional<Failure>& failure() const { return failure_; }
  // The first thing that was read through; nothing: there was none.
  [[nodiscard]] const std::optional<Failure>& flaw() const { return flaw_; }
  // The first one stays. At the value read last, or at `spot`. Nothing comes back, for who returns it.
  std::nullopt_t fail(std::string text);
  std::nullopt_t fail(const Spot& spot, std::string text);
  void replace_failure(const Spot& spot, std::string text) {
    failure_ = Failure{spot, std::move(text), false};
  }
  // The same for what is well formed but not done here: a warning, and the entity is left out.
  std::nullopt_t give_up(std::string text);
  // Where the value read last began, and the line (number in the section) on which the next one begins.
  [[nodiscard]] Spot spot() const { return value_spot_; }
  [[nodiscard]] int at_line() const { return line_; }
  // Had the string read last an h instead of an H?
  [[nodiscard]] bool has_small_letter() const { return has_small_letter_; }

 private:
  friend bool read_delimiters(Parameters& cursor);

  [[nodiscard]] Line line() const { return lines_->line(section_, line_); }
  [[nodiscard]] Spot here() const;
  void enter(int line);
  bool next_line();
  bool skip_blanks();
  [[nodiscard]] bool is_delimiter() const {
    return *at_ == delimiters_.parameter || *at_ == delimiters_.record;
  }
  void scan();
  bool field(std::string_view& token, std::string* joined = nullptr);
  bool take_delimiter();
  bool slow_real(double& value);
  bool characters(std::size_t count, std::string& text);
  bool count_goes_on() const;
  std::string string_here();
  bool text_of_line(std::size_t count, std::string& text);

  const Lines* lines_;
  Section section_;
  int line_, last_;
  Delimiters delimiters_;
  const char* at_ = nullptr;
  const char* end_ = nullptr;    // of the data on the present line
  const char* start_ = nullptr;  // of the present line
  bool done_ = false, has_small_letter_ = false;
  Spot value_spot_;
  std::optional<Failure> failure_, flaw_;
};

// What is said of a number that runs over the end of its line.
std::string broken_number(std::string_view token);

// Reads the delimiters, which are the first two values of the global section, and goes by them. False: the
// cursor has failed; what was read until then holds.
bool read_delimiters(Parameters& cursor);

// All values of a record at once, for who looks at them in any order or more than once.
class Values {
 public:
  struct Value {
    std::string_view text;  // a string's characters, or the bare text without blanks round it
    Spot spot;
    bool is_string = false;
    bool is_small = false;   // a string with h instead of H
    bool is_broken = false;  // a number that runs over the end of its line
  };

  // What `in` has left, as far as it can be taken apart: failure() then says what was wrong.
  explicit Values(Parameters in);
  Values(const Values&) = delete;
  Values& operator=(const Values&) = delete;

  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] const Value& operator[](std::size_t i) const { return values_[i]; }
  [[nodiscard]] const std::optional<Parameters::Failure>& failure() const { return failure_; }
  [[nodiscard]] const std::optional<Parameters::Failure>& flaw() const { return flaw_; }
  // Of value `i`, of the last one where there are fewer.
  [[nodiscard]] Spot spot(std::size_t i) const { return i < size() ? values_[i].spot : end_; }
  // The line (number in the section) with the record delimiter.
  [[nodiscard]] int last_line() const { return last_line_; }

  // A blank value, or one behind the end, is the default. Nothing when it is something else; an integer may
  // not be written as a real here.
  [[nodiscard]] bool is_blank(std::size_t i) const {
    return i >= size() || (!values_[i].is_string && values_[i].text.empty());
  }
  [[nodiscard]] std::optional<int> integer(std::size_t i, int otherwise = 0) const;
  [[nodiscard]] std::optional<double> real(std::size_t i, double otherwise = 0) const;

 private:
  std::vector<Value> values_;
  std::forward_list<std::string> kept_;  // what does not stand in the file in one piece
  std::optional<Parameters::Failure> failure_, flaw_;
  Spot end_;
  int last_line_ = 0;
};

}  // namespace selvage::formats::iges
