// For structure*.cpp only: a file taken apart without any judgement of its own, so that each part of it can
// be judged.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/findings.h"
#include "core/source.h"

namespace selvage::formats::iges::structure {

struct RawLine {
  std::string_view text;  // without its line end
  int number = 0;         // in the file, from 1

  // Columns from 1; what is beyond the end of the line is missing.
  [[nodiscard]] std::string_view columns(std::size_t first, std::size_t last) const {
    return first > text.size() ? std::string_view{} : text.substr(first - 1, last - first + 1);
  }
  [[nodiscard]] TextPlace place(int column = 1) const { return {number, column}; }
};

using Section = std::vector<RawLine>;
struct RawFile {
  std::array<Section, 5> sections;  // S, G, D, P, T
  char delimiter = ',', record = ';';

  [[nodiscard]] const Section& global() const { return sections[1]; }
  [[nodiscard]] const Section& directory() const { return sections[2]; }
  [[nodiscard]] const Section& parameters() const { return sections[3]; }
};

// The number in a field, blanks and leading zeros allowed; a blank field is 0. Nothing when it is none.
std::optional<int> field_number(std::string_view field);

// The values of one record: of the global section or an entity.
class Record {
 public:
  struct Value {
    std::string_view text;  // a string's characters, or the bare text without blanks round it
    bool is_string = false;
    std::size_t at = 0;  // offset in the record
  };

  // `lines` from `first`, `count` of them, of which the first `width` columns hold data.
  Record(const Section& lines, std::size_t first, std::size_t count, std::size_t width);
  Record(const Record&) = delete;
  Record& operator=(const Record&) = delete;

  // Takes the values apart from offset `at` on. What is wrong with the text is a defect of `what` ("128 at
  // D5"); false then.
  bool split(char delimiter, char record, const std::string& what, Findings& findings, std::size_t at = 0);

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const std::vector<Value>& values() const { return values_; }
  [[nodiscard]] TextPlace place(std::size_t offset) const;
  [[nodiscard]] TextPlace place_of(std::size_t value) const {
    return place(value < values_.size() ? values_[value].at : text_.size() - 1);
  }
  // Line of the record (from 0) on which it ends.
  [[nodiscard]] std::size_t last_line() const { return end_ / width_; }

  // Value `i`; a blank one, or one behind the end, is the default. Nothing when it is something else.
  [[nodiscard]] std::optional<int> integer(std::size_t i, int otherwise = 0) const;
  [[nodiscard]] std::optional<double> real(std::size_t i, double otherwise = 0) const;
  [[nodiscard]] bool is_blank(std::size_t i) const {
    return i >= values_.size() || (!values_[i].is_string && values_[i].text.empty());
  }
  [[nodiscard]] std::string_view string(std::size_t i) const {
    return i < values_.size() && values_[i].is_string ? values_[i].text : std::string_view{};
  }

 private:
  const Section& lines_;
  std::size_t first_, width_, end_ = 0;
  std::string text_;
  std::vector<Value> values_;
};

struct Entry {
  int de = 0;  // odd
  int type = 0, form = 0, first = 0, count = 0;
  int level = 0, matrix = 0, color = 0;
  int subordinate = 0, use = 0;
  const RawLine *line = nullptr, *second = nullptr;

  [[nodiscard]] std::string name() const;
};

struct Directory {
  std::vector<Entry> entries;
  [[nodiscard]] const Entry* at(int pointer) const {
    const auto index = static_cast<std::size_t>(pointer / 2);
    return pointer > 0 && pointer % 2 == 1 && index < entries.size() ? &entries[index] : nullptr;
  }
};

// What the numbers of the file must agree with.
struct Bounds {
  double largest = 0;          // parameter 20; 0: not given
  int largest_line = 0;        // of the parameter
  double largest_found = 0;    // over all control points that nothing moves
  std::string largest_entity;  // which has it
  double resolution = 0;
  int resolution_line = 0;
};

Bounds check_global(RawFile& file, Findings& findings);
Directory check_directory(const RawFile& file, Findings& findings);
void check_parameters(const RawFile& file, const Directory& directory, Bounds& bounds, Findings& findings);
// The numbers of one entity: knots, weights, flags, ranges. `own`: how many values are its own.
void check_curve(const Entry& entry, const Record& record, Bounds& bounds, Findings& findings);
void check_surface(const Entry& entry, const Record& record, Bounds& bounds, Findings& findings);
void check_matrix(const Entry& entry, const Record& record, Findings& findings);
void check_color(const Entry& entry, const Record& record, Findings& findings);

}  // namespace selvage::formats::iges::structure
