#include "core/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/number_text.h"
#include "core/readable.h"

namespace selvage {

namespace {

std::string_view without_blanks(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

// Would a spreadsheet take this for a formula? Apostrophes in front of one are those of csv_value().
bool is_formula(std::string_view value) {
  const std::size_t begin = value.find_first_not_of('\'');
  return begin != std::string_view::npos &&
         std::string_view("=+-@\t\r\n").find(value[begin]) != std::string_view::npos && !read_number(value);
}

// What csv_value() was given.
std::string_view without_mark(std::string_view value) {
  if (value.starts_with('\'') && is_formula(value)) value.remove_prefix(1);
  return value;
}

class Rows {
 public:
  Rows(std::string_view text, char separator) : text_(text), separator_(separator) {}

  // The next row that has something; empty at the end. Error: an open quote.
  Result<std::vector<std::string>> next() {
    for (; at_ < text_.size(); ++line_) {
      begin_ = line_;
      if (text_[at_] == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size() - 1) + 1;
        continue;
      }
      std::vector<std::string> row;
      const std::size_t start = at_;
      places_.clear();
      do {
        while (at_ < text_.size() && (text_[at_] == ' ' || (text_[at_] == '\t' && separator_ != '\t'))) ++at_;
        places_.push_back(static_cast<int>(at_ - start) + 1);
        if (Status read = value(row); !read) return read.error();
      } while (is_followed());
      const bool is_empty = row.size() == 1 && row.front().empty();
      if (!is_empty) {
        ++line_;
        return row;
      }
    }
    return std::vector<std::string>{};
  }
  [[nodiscard]] int line() const { return begin_; }
  [[nodiscard]] const std::vector<int>& places() const { return places_; }

 private:
  // Behind a value: is there another one in the row? Leaves the separator or the line's end behind.
  bool is_followed() {
    if (at_ >= text_.size()) return false;
    return text_[at_++] == separator_;
  }
  [[nodiscard]] bool ends_value(std::size_t i) const {
    return i >= text_.size() || text_[i] == separator_ || text_[i] == '\n';
  }

  Status value(std::vector<std::string>& row) {
    std::size_t begin = at_;
    while (begin < text_.size() && text_[begin] == ' ') ++begin;
    if (begin < text_.size() && text_[begin] == '"') return quoted(row, begin + 1);
    std::size_t stop = at_;
    while (!ends_value(stop)) ++stop;
    std::string_view value = text_.substr(at_, stop - at_);
    at_ = stop;
    if (value.ends_with('\r')) value.remove_suffix(1);
    row.emplace_back(without_mark(without_blanks(value)));
    return {};
  }

  Status quoted(std::vector<std::string>& row, std::size_t i) {
    std::string value;
    for (;; ++i) {
      if (i >= text_.size()) return error(Kind::malformed, "a quote is not closed").placed({begin_, 1});
      if (text_[i] == '"' && (i + 1 >= text_.size() || text_[++i] != '"')) break;
      if (text_[i] == '\n') ++line_;
      value += text_[i];
    }
    at_ = i;
    while (!ends_value(at_)) ++at_;
    row.emplace_back(without_mark(value));
    return {};
  }

  std::string_view text_;
  char separator_;
  std::size_t at_ = 0;
  int line_ = 1, begin_ = 1;
  std::vector<int> places_;
};

char separator_of(std::string_view text) {
  while (text.starts_with('#')) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  const std::string_view head = text.substr(0, text.find('\n'));
  for (const char separator : {',', ';', '\t'})
    if (head.find(separator) != std::string_view::npos) return separator;
  return ',';
}

}  // namespace

Result<CsvTable> read_csv(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  Rows rows(text, separator_of(text));
  CsvTable table;
  for (;;) {
    Result<std::vector<std::string>> row = rows.next();
    if (!row) return row.error();
    if (row->empty()) break;
    const TextPlace place{rows.line(), 1};
    if (table.columns.empty()) {
      table.columns = std::move(*row);
      table.head_line = place.line;
      std::set<std::string_view> names;
      for (std::size_t i = 0; i < table.columns.size(); ++i) {
        const std::string& name = table.columns[i];
        if (name.empty())
          return error(Kind::malformed, fmt::format("column {} has no name", i + 1)).placed(place);
        if (!names.insert(name).second)
          return error(Kind::malformed, fmt::format("the column '{}' is there twice", shortened(name)))
              .placed(place);
      }
      continue;
    }
    if (row->size() != table.columns.size())
      return error(Kind::malformed, fmt::format("this row has {} values, and there are {} columns",
                                                row->size(), table.columns.size()))
          .placed(place);
    table.rows.push_back(std::move(*row));
    table.lines.push_back(place.line);
    table.places.push_back(rows.places());
  }
  if (table.columns.empty())
    return error(Kind::malformed, "the file is empty: its first row names the columns").placed({1, 1});
  return table;
}

std::string csv_value(std::string_view value) {
  const bool needs_mark = is_formula(value);
  if (!needs_mark && value.find_first_of(",;\"\r\n\t") == std::string_view::npos) return std::string(value);
  std::string quoted = needs_mark ? "\"'" : "\"";
  for (const char c : value) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace selvage
