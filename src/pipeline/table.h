// Aligned columns for standard output. Cells may hold names of others: they are shortened, and made readable.
// Tables are for people: of more than `most_rows` rows the first are shown, and the number of the others (a
// report has all).
#pragma once

#include <string>
#include <vector>

namespace selvage::pipeline {

class Table {
 public:
  static constexpr std::size_t most_rows = 10000;

  explicit Table(std::vector<std::string> heads) : rows_{std::move(heads)} {}
  void add(const std::vector<std::string>& cells);
  // One line a row, indented by two; columns of numbers stand to the right, others to the left.
  [[nodiscard]] std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;  // the heads are the first
  std::size_t more_ = 0;
};

// " a b c" for a line of names of any number: shortened, of more than 100 the first and how many more there
// are.
class NameList {
 public:
  void add(std::string_view name);
  [[nodiscard]] std::string text() const;

 private:
  std::string shown_;
  std::size_t count_ = 0;
};

// Six significant digits; "-" for what is infinite or unknown.
std::string cell(double value);

}  // namespace selvage::pipeline
