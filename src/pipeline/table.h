// Aligned columns for standard output.
#pragma once

#include <string>
#include <vector>

namespace selvage::pipeline {

class Table {
 public:
  explicit Table(std::vector<std::string> heads) : rows_{std::move(heads)} {}
  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  // One line a row, indented by two; columns of numbers stand to the right, others to the left.
  [[nodiscard]] std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

// Six significant digits; "-" for what is infinite or unknown.
std::string cell(double value);

}  // namespace selvage::pipeline
