// Comma-separated values (RFC 4180): a row of column names, and rows of as many values. A file whose first
// row has no comma may have semicolons or tabs instead.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"

namespace selvage {

struct CsvTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
  int head_line = 0;                     // of the names, from 1
  std::vector<int> lines;                // where each row begins, from 1
  std::vector<std::vector<int>> places;  // the bytes' number of the row at which each value begins, from 1
};

// Blanks round values and empty lines mean nothing; lines that begin with `#` are comments. Errors
// (malformed, with the line): no column, one without a name or twice there, a row of another length, an open
// quote. What csv_value() marked comes back without its mark.
Result<CsvTable> read_csv(std::string_view text);

// A value as it stands in a row: in quotes where it has to be. What begins as a formula does in a spreadsheet
// (=, +, -, @, tab, end of line) and is no number gets an apostrophe in front, by which it is a text there
// (OWASP, "CSV Injection").
std::string csv_value(std::string_view value);

}  // namespace selvage
