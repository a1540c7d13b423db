#include "pipeline/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace selvage::pipeline {

std::string Table::text() const {
  std::vector<std::size_t> widths(rows_.front().size(), 0);
  for (const auto& row : rows_)
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
  std::vector<bool> is_number(widths.size());
  for (std::size_t k = 0; k < widths.size(); ++k)
    is_number[k] = std::all_of(rows_.begin() + 1, rows_.end(), [k](const auto& row) {
      return !row[k].empty() && row[k].find_first_not_of("0123456789.+-ex") == std::string::npos;
    });
  std::string out;
  for (const auto& row : rows_) {
    std::string line;
    for (std::size_t k = 0; k < row.size(); ++k)
      line += is_number[k] ? fmt::format("  {:>{}}", row[k], widths[k])
                           : fmt::format("  {:<{}}", row[k], widths[k]);
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
  return out;
}

std::string cell(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "-";
}

}  // namespace selvage::pipeline
