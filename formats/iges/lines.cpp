#include "formats/iges/lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "formats/iges/real_text.h"
#include "formats/iges/records.h"

namespace selvage::formats::iges {

namespace {

constexpr std::string_view blanks = " \t\r\v\f";
constexpr std::size_t columns = 80, letter_column = 72;  // from 0

std::optional<std::size_t> section_of(char letter) {
  const std::size_t section = section_letters.find(letter);
  return section == std::string_view::npos ? std::nullopt : std::optional(section);
}

std::string_view without_trailing_blanks(std::string_view text) {
  const std::size_t last = text.find_last_not_of(blanks);
  return text.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

// The column (from 0) of the section letter: 72, or one beside it where a character was lost or put in. A
// check takes it without a number behind it, too.
std::optional<std::size_t> find_letter(std::string_view line, bool is_check) {
  const auto is_letter = [&](std::size_t at) { return at < line.size() && section_of(line[at]).has_value(); };
  if (is_check && line.size() == columns && is_letter(letter_column)) return letter_column;
  for (const std::size_t at : {letter_column, letter_column - 1, letter_column + 1})
    if (is_letter(at) && is_number_field(line.substr(at + 1, 7))) return at;
  if (is_check && is_letter(letter_column)) return letter_column;
  const bool is_one_off = line.size() == columns - 1 || line.size() == columns + 1;
  return is_check && is_one_off && is_letter(line.size() - 8) ? std::optional(line.size() - 8) : std::nullopt;
}

bool is_printable(char c) {
  return c >= ' ' && c <= '~';
}

// Only a check minds.
void check_characters(std::string_view text, const Line& line, Complaints& complaints) {
  bool good = true;
  for (const char c : text) good &= is_printable(c);
  if (good) return;
  const auto* const bad = std::find_if_not(text.begin(), text.end(), is_printable);
  const Spot spot = line.spot(static_cast<int>(bad - text.begin()) + 1);
  std::string what =
      fmt::format("the byte 0x{:02X} is not printable ASCII", static_cast<unsigned char>(*bad));
  // Letters of other alphabets stand in names; receivers at most show them wrongly.
  (*bad & 0x80) != 0 ? complaints.warning(spot, std::move(what)) : complaints.defect(spot, std::move(what));
}

// What this is instead of fixed-length ASCII. False: a reader stops here.
bool check_form(std::string_view bytes, Complaints& complaints) {
  const auto other = [&](std::string text, Kind kind = Kind::unsupported) {
    return complaints.fault(Spot(), std::move(text), kind);
  };
  const std::string_view head = bytes.substr(0, bytes.find_first_of("\r\n"));
  if (head.size() > letter_column && head[letter_column] == 'C' && is_number_field(head.substr(73, 7)))
    return other(
        "this is compressed ASCII IGES, which is not read: let the sending program write fixed-length ASCII");
  const bool has_zeros = bytes.substr(0, 4096).find('\0') != std::string_view::npos;
  if (bytes.starts_with('B') && (has_zeros || (head.size() > letter_column && head[letter_column] == 'B')))
    return other("this is binary IGES, which is not read: let the sending program write fixed-length ASCII");
  return !has_zeros || other("this is no IGES file: it has zero bytes", Kind::malformed);
}

}  // namespace

bool is_number_field(std::string_view field) {
  return std::ranges::all_of(field, [](char c) { return c == ' ' || is_digit(c); });
}

std::optional<int> column_number(std::string_view field) {
  const std::size_t first = field.find_first_not_of(' ');
  if (first == std::string_view::npos) return 0;
  field = without_trailing_blanks(field.substr(first));
  const bool negative = field.starts_with('-');
  if (negative || field.starts_with('+')) field.remove_prefix(1);
  if (field.empty() || field.size() > 9) return std::nullopt;
  int value = 0;
  for (const char c : field) {
    if (!is_digit(c)) return std::nullopt;
    value = 10 * value + (c - '0');
  }
  return negative ? -value : value;
}

// The order of sections and of the numbers in them, line for line.
class Lines::Order {
 public:
  explicit Order(Complaints& complaints) : complaints_(complaints) { enter(0); }

  // `letter`: the section letter and the seven characters behind it; `column`: where it stands, from 1.
  // False: a reader stops here.
  bool add(const char* letter, int column, const Line& line) {
    if (std::memcmp(letter, expected_.data(), expected_.size()) != 0) return add_odd(letter, column, line);
    ++last_[section_];
    count_up();
    return true;
  }
  [[nodiscard]] std::size_t section() const { return section_; }

 private:
  // What is expected of the next line, where nothing has to be said of it whatever it is.
  void enter(std::size_t section) {
    section_ = section;
    furthest_ = std::max(section, furthest_);
    if (section < furthest_ || last_[section] >= most_lines)
      expected_.fill('\0');
    else
      fmt::format_to_n(expected_.data(), expected_.size(), "{}{:>7}", section_letters[section],
                       last_[section] + 1);
  }
  // Behind the last number that there is it counts up the letter, too, and nothing is as expected.
  void count_up() {
    char* digit = &expected_[7];
    while (*digit == '9') *digit-- = '0';
    *digit = *digit == ' ' ? '1' : static_cast<char>(*digit + 1);
  }

  bool add_odd(const char* letter, int column, const Line& line);
  bool check_number(std::size_t section, std::string_view field, const Spot& spot);

  Complaints& complaints_;
  std::size_t section_ = 0, furthest_ = 0;
  std::array<int, section_count> last_{};  // number of the last line of each section
  std::array<char, 8> expected_{};         // letter and number of the next line
};

bool Lines::Order::add_odd(const char* letter, int column, const Line& line) {
  const std::size_t section = *section_of(*letter);
  if (section < furthest_ &&
      !complaints_.fault(line.spot(column), fmt::format("a line of the {} section after the {} section",
                                                        section_names[section], section_names[furthest_])))
    return false;
  if (++last_[section] > most_lines &&
      !complaints_.fault(line.spot(column), fmt::format("the {} section has more than {} lines",
                                                        section_names[section], most_lines)))
    return false;
  if (!check_number(section, {letter + 1, 7}, line.spot(column + 1))) return false;
  enter(section);
  return true;
}

bool Lines::Order::check_number(std::size_t section, std::string_view field, const Spot& spot) {
  int& due = last_[section];
  const bool is_blank = field.find_first_not_of(' ') == std::string_view::npos;
  const std::optional<int> number = is_blank ? std::nullopt : column_number(field);
  if (!number) {
    complaints_.habit("sequence numbers that are none", spot, [&] {
      return fmt::format("columns 74-80 hold {}, not the sequence number {}", in_quotes(field), due);
    });
  } else if (*number != due) {
    const auto text = [&] {
      return fmt::format("sequence number {}{} follows {}: {}", section_letters[section], *number,
                         due > 1 ? fmt::format("{}{}", section_letters[section], due - 1) : "the start",
                         *number > due ? "lines are missing" : "repeated or out of order");
    };
    // Directory and parameter lines are found by their numbers.
    if (section != 2 && section != 3)
      complaints_.habit("sequence numbers out of order", spot, text);
    else if (!complaints_.fault(spot, text()))
      return false;
    if (complaints_.is_check()) due = *number;
  } else if (field.back() == ' ') {
    complaints_.warning(spot, "the sequence number is not right-justified");
  }
  return true;
}

// Is it the usual file, of which every line has 80 columns and the same end? For a check only one with
// its sections in order, too, and no line end within its columns.
bool Lines::find_stride(bool is_check) {
  std::string_view bytes = bytes_;
  const bool has_end = bytes.ends_with('\n');
  if (has_end) bytes.remove_suffix(1);
  if (has_end && bytes.size() > columns && bytes[columns] == '\r') {
    if (bytes.back() != '\r') return false;
    bytes.remove_suffix(1);
  }
  const std::size_t size = bytes.size();
  if (size < columns) return false;
  const std::size_t newline = bytes.substr(0, columns + 2).find('\n');
  std::size_t stride = 0;
  if (newline == columns) {
    stride = columns + 1;
  } else if (newline == columns + 1 && bytes[columns] == '\r') {
    stride = columns + 2;
  } else if (newline == std::string_view::npos && size % columns == 0 &&
             (size == columns || section_of(bytes[columns + letter_column]))) {
    stride = columns;
  } else {
    return false;
  }
  if ((size + stride - columns) % stride != 0) return false;
  const auto count = static_cast<std::int64_t>((size + stride - columns) / stride);
  if (count > static_cast<std::int64_t>(section_count) * most_lines) return false;
  const char* at = bytes.data();
  std::array<Range, section_count> ranges{};
  std::size_t last = 0;
  for (int i = 0; i < static_cast<int>(count); ++i, at += stride) {
    const std::optional<std::size_t> section = section_of(at[letter_column]);
    if (!section) return false;
    if (is_check && (*section < last || at[columns - 1] == '\r' || std::memchr(at, '\n', columns) != nullptr))
      return false;
    last = *section;
    if (ranges[last].count++ == 0) ranges[last].first = i;
    if (i + 1 == static_cast<int>(count)) break;
    if ((stride > columns && at[stride - 1] != '\n') || (stride == columns + 2 && at[columns] != '\r'))
      return false;
  }
  bytes_ = bytes;
  stride_ = stride;
  ranges_ = ranges;
  end_ = {size, static_cast<int>(count), static_cast<int>(columns) + 1};
  return true;
}

bool Lines::index_regular(Complaints& complaints) {
  if (stride_ == columns)
    complaints.defect(Spot().behind(columns),
                      "the lines have no ends: they follow each other every 80 columns");
  Order order(complaints);
  const char* at = bytes_.data();
  for (int i = 1; i <= end_.line; ++i, at += stride_) {
    const auto offset = static_cast<std::size_t>(at - bytes_.data());
    const Line line{at, offset, static_cast<int>(columns), 72, i};
    if (complaints.is_check()) check_characters(line.text(), line, complaints);
    if (!order.add(at + letter_column, 73, line)) return false;
  }
  return true;
}

// One line of any kind, whose letter was found. False: a reader stops here.
bool Lines::add_irregular(Line line, std::size_t letter, Order& order, Complaints& complaints) {
  const std::string_view text = line.text();
  const char section = text[letter];
  const int column = static_cast<int>(letter) + 1;
  line.is_shifted = letter != letter_column;
  if (line.is_shifted && section == 'D' &&
      !complaints.fault(
          line.spot(column),
          fmt::format("the section letter stands in column {} instead of 73, so that the fields "
                      "of this directory line cannot be told apart",
                      column)))
    return false;
  if (line.is_shifted && section != 'D')
    complaints.habit("lines with their letter beside its column", line.spot(column), [&] {
      return fmt::format("the section letter stands in column {} instead of 73", column);
    });
  if (text.size() > letter + 8)
    complaints.habit("lines with more than their number", line.spot(column + 8),
                     [] { return std::string("what stands behind the line number is passed over"); });
  line.data = column - (section == 'P' ? 9 : 1);
  std::array<char, 8> tail;
  tail.fill(' ');
  std::memcpy(tail.data(), text.data() + letter, std::min<std::size_t>(8, text.size() - letter));
  if (!order.add(tail.data(), column, line)) return false;
  irregular_[order.section()].push_back(line);
  return true;
}

bool Lines::index_irregular(Complaints& complaints) {
  Order order(complaints);
  int number = 0;
  std::array<int, 2> ends{};  // with LF, with CR LF
  for (std::string_view rest = bytes_; !rest.empty();) {
    const std::size_t newline = rest.find('\n');
    std::string_view text = rest.substr(0, newline);
    rest.remove_prefix(newline == std::string_view::npos ? rest.size() : newline + 1);
    const bool dos = text.ends_with('\r');
    if (dos) text.remove_suffix(1);
    if (newline != std::string_view::npos) ++ends[dos ? 1 : 0];
    const std::string_view trimmed = without_trailing_blanks(text);
    Line line{text.data(), static_cast<std::size_t>(text.data() - bytes_.data()),
              static_cast<int>(std::min<std::size_t>(trimmed.size(), 1'000'000)), 72, ++number};
    end_ = line.spot(line.length + 1);
    if (number > static_cast<int>(section_count) * most_lines) {
      complaints.fault(line.spot(), "the file has more lines than IGES can number");
      return complaints.is_check();
    }
    if (trimmed.empty() || (complaints.is_check() && trimmed == "\x1A")) {
      // Behind the end of the file it is no part of it.
      if (complaints.is_check() && count(Section::terminate) > 0)
        complaints.warning(line.spot(), "an empty line behind the terminate line");
      else
        complaints.habit("empty lines", line.spot(),
                         [] { return std::string("an empty line is passed over"); });
      continue;
    }
    if (!complaints.is_check() && count(Section::terminate) == 1) {
      complaints.reader_warning(line.spot(), "what follows the terminate section is passed over");
      break;
    }
    if (complaints.is_check()) {
      if (text.size() != columns)
        complaints.defect(line.spot(), fmt::format("the line has {} columns; 80 are due", text.size()));
      check_characters(text, line, complaints);
    }
    const std::optional<std::size_t> letter = find_letter(line.text(), complaints.is_check());
    if (letter ? !add_irregular(line, *letter, order, complaints)
               : !complaints.fault(
                     line.spot(std::min(line.length, static_cast<int>(letter_column)) + 1),
                     fmt::format("no section letter (S, G, D, P or T) in column 73 of a line of {} columns",
                                 text.size())))
      return false;
  }
  if (ends[0] > 0 && ends[1] > 0)
    complaints.warning({0, 0, 0}, fmt::format("{} lines end with CR LF, {} with LF", ends[1], ends[0]));
  return true;
}

// Which sections there are, and what the terminate line says of their lengths.
void Lines::check_sections(Complaints& complaints) const {
  for (std::size_t i = 0; i < section_count; ++i) {
    if (count(static_cast<Section>(i)) > 0) continue;
    const std::string text = fmt::format("there is no {} section", section_names[i]);
    if (i == 1)
      complaints.fault(end_, text);
    else if (i == 4)
      complaints.flaw(end_, text + ": the file may be cut off");
    else
      complaints.defect(end_, text);
  }
  const int terminates = count(Section::terminate);
  if (terminates == 0) return;
  if (terminates > 1)
    complaints.flaw(line(Section::terminate, 2).spot(), "there is more than one terminate line");
  const Line last = line(Section::terminate, 1);
  for (std::size_t i = 0; i < section_count - 1; ++i) {
    const std::string_view field = last.text().substr(8 * i, 8);
    const std::optional<int> said =
        field[0] == section_letters[i] ? column_number(field.substr(1)) : std::nullopt;
    const int there = count(static_cast<Section>(i));
    if (said == there) continue;
    complaints.flaw(last.spot(static_cast<int>(8 * i) + 1),
                    said ? fmt::format("the terminate line counts {} lines in the {} section; there are {}",
                                       *said, section_names[i], there)
                         : fmt::format("the terminate line says {} where the number of {} lines is due",
                                       in_quotes(field), section_names[i]));
  }
}

std::optional<Lines> Lines::index(const Source& source, Complaints& complaints) {
  Lines lines;
  const std::string_view bytes = source.bytes();
  const std::size_t last = bytes.find_last_not_of(std::string_view(" \t\r\n\v\f\0\x1A", 8));
  if (last == std::string_view::npos) {
    complaints.fault(lines.end_, "the file is empty");
    if (!complaints.is_check()) return std::nullopt;
  } else if (!check_form(bytes, complaints)) {
    return std::nullopt;
  }
  // A check judges blank lines at the end, too.
  lines.bytes_ = complaints.is_check() ? bytes : bytes.substr(0, last + 1);
  const bool is_regular = lines.find_stride(complaints.is_check());
  if (!(is_regular ? lines.index_regular(complaints) : lines.index_irregular(complaints)))
    return std::nullopt;
  if (bytes.find('\n', last) == std::string_view::npos && lines.stride_ != columns)
    complaints.reader_warning(lines.end_, "the last line has no line end: the file may be cut off");
  lines.check_sections(complaints);
  return lines;
}

}  // namespace selvage::formats::iges
