// Values of WIF entries: whole numbers, reals, booleans, lists, and sections whose keys are numbers. What is
// wrong goes to the report, at the value's place.
#pragma once

#include <limits>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include "formats/wif/ini.h"

namespace selvage::formats::wif {

// More threads of a system, shafts or treadles than that are taken for a mistake.
inline constexpr int most_threads = 1'000'000;

// A value without the comment that may follow it behind a ';'. (Not for texts: a title may have a ';'.)
std::string_view without_comment(std::string_view value);

// The value as it should be; nothing after an error.
std::optional<int> whole_number(const Entry& entry, TextReport& report);
std::optional<double> real_number(const Entry& entry, TextReport& report);
std::optional<bool> boolean(const Entry& entry, TextReport& report);
// Whole numbers separated by commas; empty parts are passed by ("1,2," is written by some).
std::optional<std::vector<int>> whole_numbers(const Entry& entry, TextReport& report);

// An entry whose key is a number from 1.
struct Numbered {
  int number = 0;
  const Entry* entry = nullptr;
  // "4=" and "4=0" say the same as no entry at all.
  [[nodiscard]] bool is_nothing() const;
};

// What a numbered section's keys count. `limit`: the section that says `most`, as "[WARP]"; empty: none does.
struct Counted {
  std::string_view noun;  // "thread"
  int most = most_threads;
  std::string_view limit = {};
  // Numbers beyond `most` are taken, too, with a warning: programs write the tie-up of the whole loom, and
  // count the shafts and treadles that the draft needs.
  bool is_soft = false;
};

// Numbers of one section beyond those that it counts, for one warning.
class Surplus {
 public:
  explicit Surplus(const Counted& counted) : counted_(counted) {}
  void add(int number, const Spot& spot);
  void report_of(const Section& section, TextReport& report) const;

 private:
  const Counted& counted_;
  std::set<int> numbers_;
  Spot first_;
};

// Is `number` within 1..most, or taken beyond that (`surplus`, which may be null where the count is
// not soft)? Else an error at `entry`'s value that says
// so.
bool is_within(int number, const Counted& counted, const Entry& entry, Surplus* surplus, TextReport& report);

// The section's entries with numbers 1..counted.most, ascending, and greater ones where the count is soft.
// Errors: other keys, and greater numbers unless they carry nothing, which is a warning like a number that
// stands there twice (the first one counts) or a line without '='.
std::vector<Numbered> numbered(const Section& section, const Counted& counted, TextReport& report);

}  // namespace selvage::formats::wif
