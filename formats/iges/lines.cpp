#include "formats/iges/lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "formats/iges/records.h"

namespace selvage::formats::iges {

namespace {

constexpr std::string_view letters = "SGDPT";
constexpr std::string_view blanks = " \t\r\v\f";
constexpr std::size_t columns = 80, letter_column = 72;  // from 0
constexpr std::array<std::string_view, section_count> names = {"start", "global", "directory", "parameter",
                                                               "terminate"};

std::optional<std::size_t> section_of(char letter) {
  switch (letter) {
    case 'P':
      return 3;
    case 'D':
      return 2;
    case 'G':
      return 1;
    case 'S':
      return 0;
    case 'T':
      return 4;
    default:
      return std::nullopt;
  }
}

std::string_view without_trailing_blanks(std::string_view text) {
  const std::size_t last = text.find_last_not_of(blanks);
  return text.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

bool is_number_field(std::string_view field) {
  return std::all_of(field.begin(), field.end(), [](char c) { return c == ' ' || (c >= '0' && c <= '9'); });
}

// The column (from 0) of the section letter: 72, or one beside it where a character was lost or put in.
std::optional<std::size_t> find_letter(std::string_view line) {
  for (const std::size_t at : {letter_column, letter_column - 1, letter_column + 1})
    if (at < line.size() && section_of(line[at]) && is_number_field(line.substr(at + 1, 7))) return at;
  return std::nullopt;
}

}  // namespace

std::optional<int> column_number(std::string_view field, bool& valid) {
  const std::size_t first = field.find_first_not_of(' ');
  if (first == std::string_view::npos) return std::nullopt;
  field = without_trailing_blanks(field.substr(first));
  const bool negative = field.starts_with('-');
  if (negative || field.starts_with('+')) field.remove_prefix(1);
  int value = 0;
  valid = valid && !field.empty() && field.size() <= 9;
  for (const char c : field.substr(0, 9)) {
    if (c < '0' || c > '9') valid = false;
    value = 10 * value + (c - '0');
    if (!valid) return 0;
  }
  return negative ? -value : value;
}

// The order of sections and of the numbers in them, line for line.
class Lines::Order {
 public:
  Order(Lines& lines, TextReport& report) : lines_(lines), report_(report) { restart(0); }

  // `letter`: the section letter and the seven characters behind it; `column`: where it stands, from 1.
  // False: an error was reported.
  bool add(const char* letter, int column, int index, const Line& line) {
    if (std::memcmp(letter, expected_.data(), expected_.size()) == 0) {
      ++lines_.ranges_[section_].count;
      count_up();
      return true;
    }
    return add_odd(letter, column, index, line);
  }
  [[nodiscard]] std::size_t section() const { return section_; }

 private:
  void restart(std::size_t section) {
    section_ = section;
    expected_ = {letters[section], ' ', ' ', ' ', ' ', ' ', ' ', '1'};
  }
  void count_up() {
    char* digit = &expected_[7];
    while (*digit == '9') *digit-- = '0';
    *digit = *digit == ' ' ? '1' : static_cast<char>(*digit + 1);
  }

  bool add_odd(const char* letter, int column, int index, const Line& line);

  Lines& lines_;
  TextReport& report_;
  std::size_t section_ = 0;
  std::array<char, 8> expected_{};  // letter and number of the next line
  bool numbers_warned_ = false;
};

bool Lines::Order::add_odd(const char* letter, int column, int index, const Line& line) {
  const std::size_t found = section_of(*letter).value_or(section_count);
  if (found == section_count || found < section_) {
    report_.error(line.spot(column), found == section_count
                                         ? std::string("no section letter (S, G, D, P or T) in column 73")
                                         : fmt::format("a line of the {} section after the {} section",
                                                       names[found], names[section_]));
    return false;
  }
  if (found != section_ || lines_.ranges_[section_].count == 0) {
    restart(found);
    lines_.ranges_[found].first = index;
  }
  Range& range = lines_.ranges_[found];
  if (range.count == most_lines) {
    report_.error(line.spot(column),
                  fmt::format("the {} section has more than {} lines", names[found], most_lines));
    return false;
  }
  ++range.count;
  if (std::memcmp(letter, expected_.data(), expected_.size()) != 0) {
    bool valid = true;
    const std::optional<int> number = column_number({letter + 1, 7}, valid);
    const bool is_serious = found == 2 || found == 3;
    if (valid && number && *number != range.count && is_serious) {
      report_.error(
          line.spot(column + 1),
          fmt::format("line {} of the {} section stands where line {} is due: lines are missing or out of "
                      "order",
                      *number, names[found], range.count));
      return false;
    }
    if ((!valid || number.value_or(-1) != range.count) && !numbers_warned_) {
      numbers_warned_ = true;
      report_.warning(line.spot(column + 1),
                      fmt::format("this is line {} of the {} section, but it is not numbered so", range.count,
                                  names[found]));
    }
  }
  count_up();
  return true;
}

// The usual file: every line has 80 columns and the same end. False where it is not so; `failed` where an
// error was reported.
bool Lines::index_regular(TextReport& report, bool& failed) {
  const std::size_t size = bytes_.size();
  if (size < columns) return false;
  const std::size_t newline = bytes_.substr(0, columns + 2).find('\n');
  std::size_t stride = 0;
  if (newline == columns) {
    stride = columns + 1;
  } else if (newline == columns + 1 && bytes_[columns] == '\r') {
    stride = columns + 2;
  } else if (newline == std::string_view::npos && size % columns == 0 &&
             (size == columns || section_of(bytes_[columns + letter_column]))) {
    stride = columns;
  } else {
    return false;
  }
  if ((size + stride - columns) % stride != 0) return false;
  const auto count = static_cast<std::int64_t>((size + stride - columns) / stride);
  if (count > static_cast<std::int64_t>(section_count) * most_lines) return false;
  const char* at = bytes_.data();
  for (std::int64_t i = 1; i <= count; ++i, at += stride) {
    if (!section_of(at[letter_column])) return false;
    if (i == count) break;
    if ((stride > columns && at[stride - 1] != '\n') || (stride == columns + 2 && at[columns] != '\r'))
      return false;
  }
  stride_ = stride;
  at = bytes_.data();
  Order order(*this, report);
  for (int i = 0; i < static_cast<int>(count); ++i, at += stride)
    if (!order.add(at + letter_column, 73, i, {at, static_cast<int>(columns), 72, i + 1})) {
      failed = true;
      return true;
    }
  end_ = {at - stride + columns, static_cast<int>(count), static_cast<int>(columns) + 1};
  return true;
}

bool Lines::index_irregular(TextReport& report) {
  Order order(*this, report);
  int number = 0;
  bool blank_warned = false, shift_warned = false, long_warned = false;
  for (std::string_view rest = bytes_; !rest.empty();) {
    const std::size_t newline = rest.find('\n');
    std::string_view text = rest.substr(0, newline);
    rest.remove_prefix(newline == std::string_view::npos ? rest.size() : newline + 1);
    text = without_trailing_blanks(text);
    Line line{text.data(), static_cast<int>(std::min<std::size_t>(text.size(), 1'000'000)), 72, ++number};
    end_ = line.spot(line.length + 1);
    if (number > static_cast<int>(section_count) * most_lines) {
      report.error(line.spot(), "the file has more lines than IGES can number");
      return false;
    }
    if (text.empty()) {
      if (!std::exchange(blank_warned, true)) report.warning(line.spot(), "an empty line is passed over");
      continue;
    }
    if (order.section() == static_cast<std::size_t>(Section::terminate) && count(Section::terminate) == 1) {
      report.warning(line.spot(), "what follows the terminate section is passed over");
      break;
    }
    const std::optional<std::size_t> letter = find_letter(text);
    if (!letter) {
      report.error(line.spot(std::min(line.length, static_cast<int>(letter_column)) + 1),
                   fmt::format("{} without a section letter (S, G, D, P or T) and a number in columns 73-80",
                               line.length < static_cast<int>(columns)
                                   ? fmt::format("a line of {} columns", line.length)
                                   : std::string("a line")));
      return false;
    }
    const char section = text[*letter];
    line.is_shifted = *letter != letter_column;
    if (line.is_shifted && section == 'D') {
      report.error(
          line.spot(static_cast<int>(*letter) + 1),
          fmt::format("the section letter stands in column {} instead of 73, so that the fields of this "
                      "directory line cannot be told apart",
                      *letter + 1));
      return false;
    }
    if (line.is_shifted && !std::exchange(shift_warned, true))
      report.warning(line.spot(static_cast<int>(*letter) + 1),
                     fmt::format("the section letter stands in column {} instead of 73", *letter + 1));
    if (text.size() > *letter + 8 && !std::exchange(long_warned, true))
      report.warning(line.spot(static_cast<int>(*letter) + 9),
                     "what stands behind the line number is passed over");
    line.data = static_cast<int>(*letter) - (section == 'P' ? 8 : 0);
    std::array<char, 8> tail;
    tail.fill(' ');
    const std::size_t there = std::min<std::size_t>(8, text.size() - *letter);
    std::memcpy(tail.data(), text.data() + *letter, there);
    // The number is right-justified where blanks were not cut off behind it.
    if (!order.add(there == 8 ? text.data() + *letter : tail.data(), static_cast<int>(*letter) + 1,
                   static_cast<int>(irregular_.size()), line))
      return false;
    irregular_.push_back(line);
  }
  return true;
}

std::optional<Lines> Lines::index(const Source& source, TextReport& report) {
  Lines lines;
  std::string_view bytes = source.bytes();
  const Spot start{bytes.data(), 1, 1};
  const std::size_t last = bytes.find_last_not_of(std::string_view(" \t\r\n\v\f\0\x1A", 8));
  if (last == std::string_view::npos) {
    report.error(start, "the file is empty");
    return std::nullopt;
  }
  const bool has_end = bytes.find('\n', last) != std::string_view::npos;
  lines.bytes_ = bytes.substr(0, last + 1);
  const std::string_view head = bytes.substr(0, bytes.find_first_of("\r\n"));
  if (head.size() > letter_column && head[letter_column] == 'C' && is_number_field(head.substr(73, 7))) {
    report.error(
        start,
        "this is compressed ASCII IGES, which is not read: let the sending program write fixed-length ASCII",
        Kind::unsupported);
    return std::nullopt;
  }
  const bool has_zeros = bytes.substr(0, 4096).find('\0') != std::string_view::npos;
  if (bytes.front() == 'B' && (has_zeros || (head.size() > letter_column && head[letter_column] == 'B'))) {
    report.error(start,
                 "this is binary IGES, which is not read: let the sending program write fixed-length ASCII",
                 Kind::unsupported);
    return std::nullopt;
  }
  if (has_zeros) {
    report.error(start, "this is no IGES file: it has zero bytes");
    return std::nullopt;
  }
  bool failed = false;
  if (!lines.index_regular(report, failed)) failed = !lines.index_irregular(report);
  if (failed) return std::nullopt;
  if (!has_end && lines.stride_ != columns)
    report.warning(lines.end_, "the last line has no line end: the file may be cut off");
  return lines;
}

}  // namespace selvage::formats::iges
