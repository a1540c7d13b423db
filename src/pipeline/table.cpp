#include "pipeline/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/readable.h"

namespace selvage::pipeline {

namespace {

constexpr std::size_t most_names = 100;

std::string spaces(std::size_t wanted, std::size_t taken) {
  return std::string(wanted - std::min(wanted, taken), ' ');
}

}  // namespace

void Table::add(const std::vector<std::string>& cells) {
  if (rows_.size() > most_rows) {
    ++more_;
    return;
  }
  std::vector<std::string>& row = rows_.emplace_back();
  // The last column makes no other wider.
  for (std::size_t i = 0; i < cells.size(); ++i)
    row.push_back(i + 1 < cells.size() ? shortened(cells[i]) : shortened(cells[i], 120));
}

std::string Table::text() const {
  std::vector<std::size_t> widths(rows_.front().size(), 0);
  for (const auto& row : rows_)
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], columns_of(row[k]));
  std::vector<bool> is_number(widths.size());
  for (std::size_t k = 0; k < widths.size(); ++k)
    is_number[k] = std::all_of(rows_.begin() + 1, rows_.end(), [k](const auto& row) {
      return !row[k].empty() && row[k].find_first_not_of("0123456789.+-ex") == std::string::npos;
    });
  std::string out;
  for (const auto& row : rows_) {
    std::string line;
    for (std::size_t k = 0; k < row.size(); ++k) {
      const std::string gap = spaces(widths[k], columns_of(row[k]));
      line += is_number[k] ? "  " + gap + row[k] : "  " + row[k] + gap;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
  if (more_ > 0) out += fmt::format("  ... and {} more\n", more_);
  return out;
}

void NameList::add(std::string_view name) {
  if (++count_ <= most_names) shown_ += " " + shortened(name);
}

std::string NameList::text() const {
  return count_ > most_names ? fmt::format("{} ... and {} more", shown_, count_ - most_names) : shown_;
}

std::string cell(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "-";
}

}  // namespace selvage::pipeline
