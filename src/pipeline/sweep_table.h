// The table of a sweep: parameters and results, a row for each variant; of `info` one for each input.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/inputs.h"
#include "pipeline/options.h"

namespace selvage::pipeline {

class SweepTable {
 public:
  // `subject`: the head of the first column.
  explicit SweepTable(std::string subject) : subject_(std::move(subject)) {}
  // `entry`: what the variant's report says, as JSON text; empty: it was not reached.
  void add(const Input& input, std::string_view entry);
  // CSV: the variant or input, the params, result (ok, defect, failed, not done), numbers of the report
  // (lengths in mm) in the order in which they first come, and the first error.
  [[nodiscard]] std::string text() const;

 private:
  struct Row {
    std::map<std::string, std::string> values;
  };
  void set(Row& row, std::vector<std::string>& columns, const std::string& column, std::string value);

  std::string subject_;
  std::vector<std::string> params_, results_;  // columns
  std::vector<Row> rows_;
};

}  // namespace selvage::pipeline
