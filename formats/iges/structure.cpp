#include "formats/iges/structure.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "core/text_report.h"
#include "formats/iges/structure_file.h"

namespace selvage::formats::iges {

namespace structure {

namespace {

constexpr std::string_view letters = "SGDPT";
constexpr std::array<std::string_view, 5> names = {"start", "global", "directory", "parameter", "terminate"};

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

// Sections in order, sequence numbers, and the lines themselves.
class LineCheck {
 public:
  LineCheck(RawFile& file, Findings& findings) : file_(file), findings_(findings) {}

  void run(std::string_view bytes) {
    int number = 0;
    while (!bytes.empty()) {
      const std::size_t end = bytes.find('\n');
      std::string_view line = bytes.substr(0, end);
      const bool dos = line.ends_with('\r');
      if (dos) line.remove_suffix(1);
      (dos ? dos_ : unix_) += end != std::string_view::npos ? 1 : 0;
      add({line, ++number});
      if (end == std::string_view::npos) break;
      bytes.remove_prefix(end + 1);
    }
    if (dos_ > 0 && unix_ > 0)
      findings_.warning("line ends", fmt::format("{} lines end with CR LF, {} with LF", dos_, unix_));
    for (std::size_t i = 0; i < letters.size(); ++i)
      if (file_.sections[i].empty())
        findings_.defect("missing sections", fmt::format("there is no {} section", names[i]), {number, 0});
    check_terminate();
  }

 private:
  void add(const RawLine& line) {
    if (trimmed(line.text).empty() || line.text == "\x1A") {
      findings_.defect("empty lines", "a line without a section letter", line.place());
      return;
    }
    if (line.text.size() != 80)
      findings_.defect("lines of a wrong length",
                       fmt::format("the line has {} columns; 80 are due", line.text.size()), line.place());
    check_characters(line);
    // Where one character was lost or put in, the section letter stands beside its column.
    const std::size_t length = line.text.size();
    const bool shifted =
        (length == 79 || length == 81) && letters.find(line.text[72]) == std::string_view::npos;
    const std::size_t column = shifted ? length - 7 : 73;
    const std::size_t section =
        length >= column ? letters.find(line.text[column - 1]) : std::string_view::npos;
    if (section == std::string_view::npos) {
      findings_.defect("lines without a section letter", "no section letter (S, G, D, P or T) in column 73",
                       line.place(73));
      return;
    }
    if (section < last_)
      findings_.defect(
          "lines out of their section",
          fmt::format("a line of the {} section after the {} section", names[section], names[last_]),
          line.place(73));
    last_ = std::max(last_, section);
    check_number(line, section, column + 1);
    file_.sections[section].push_back(line);
  }

  void check_characters(const RawLine& line) {
    const auto bad =
        std::find_if(line.text.begin(), line.text.end(), [](char c) { return c < ' ' || c > '~'; });
    if (bad == line.text.end()) return;
    findings_.defect(
        "lines with characters that are not printable ASCII",
        fmt::format("the byte 0x{:02X} is not printable ASCII", static_cast<unsigned char>(*bad)),
        line.place(static_cast<int>(bad - line.text.begin()) + 1));
  }

  void check_number(const RawLine& line, std::size_t section, std::size_t column) {
    const std::string_view field = line.columns(column, column + 6);
    int& expected = ++expected_[section];
    const std::optional<int> number = trimmed(field).empty() ? std::nullopt : field_number(field);
    if (!number) {
      findings_.defect(
          "sequence numbers that are none",
          fmt::format("columns 74-80 hold {}, not the sequence number {}", in_quotes(field), expected),
          line.place(74));
      return;
    }
    if (*number != expected)
      findings_.defect(
          "sequence numbers out of order",
          fmt::format("sequence number {}{} follows {}{}", letters[section], *number,
                      expected > 1 ? fmt::format("{}{}", letters[section], expected - 1) : "the start",
                      *number > expected   ? ": lines are missing"
                      : *number < expected ? ": repeated or out of order"
                                           : ""),
          line.place(74));
    else if (field.back() == ' ')
      findings_.warning("sequence numbers that are not right-justified",
                        "the sequence number is not right-justified", line.place(74));
    expected = *number;
  }

  void check_terminate() {
    const Section& lines = file_.sections[4];
    if (lines.empty()) return;
    if (lines.size() > 1)
      findings_.defect("terminate lines", "there is more than one terminate line", lines[1].place());
    for (std::size_t i = 0; i < 4; ++i) {
      const std::string_view field = lines[0].columns(8 * i + 1, 8 * i + 8);
      const std::optional<int> count = field.size() == 8 ? field_number(field.substr(1)) : std::nullopt;
      const TextPlace place = lines[0].place(static_cast<int>(8 * i) + 1);
      if (field.empty() || field[0] != letters[i] || !count)
        findings_.defect("fields of the terminate line",
                         fmt::format("the terminate line says {} where the number of {} lines is due",
                                     in_quotes(field), names[i]),
                         place);
      else if (*count != static_cast<int>(file_.sections[i].size()))
        findings_.defect("fields of the terminate line",
                         fmt::format("the terminate line counts {} lines in the {} section; there are {}",
                                     *count, names[i], file_.sections[i].size()),
                         place);
    }
  }

  RawFile& file_;
  Findings& findings_;
  std::array<int, 5> expected_{};
  std::size_t last_ = 0;
  int dos_ = 0, unix_ = 0;
};

bool is_number_start(std::string_view text, std::size_t at) {
  return at < text.size() && text[at] >= '0' && text[at] <= '9';
}

}  // namespace

std::optional<int> field_number(std::string_view field) {
  const std::string_view text = trimmed(field);
  if (text.empty()) return 0;
  int value = 0;
  const char* first = text.data() + (text[0] == '+' ? 1 : 0);
  const auto [end, code] = std::from_chars(first, text.data() + text.size(), value);
  if (code != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string Entry::name() const {
  return fmt::format("{} at D{}", type, de);
}

Record::Record(const Section& lines, std::size_t first, std::size_t count, std::size_t width)
    : lines_(lines), first_(first), width_(width) {
  text_.reserve(count * width);
  for (std::size_t i = first; i < first + count && i < lines.size(); ++i) {
    text_ += lines[i].text.substr(0, width);
    text_.resize((i - first + 1) * width, ' ');
  }
}

TextPlace Record::place(std::size_t offset) const {
  const std::size_t line = first_ + offset / width_;
  return line < lines_.size() ? lines_[line].place(static_cast<int>(offset % width_) + 1) : TextPlace{};
}

bool Record::split(char delimiter, char record, const std::string& what, Findings& findings, std::size_t at) {
  const auto bad = [&](std::string_view kind, std::string text, std::size_t offset) {
    findings.defect(kind, fmt::format("{}: {}", what, text), place(std::min(offset, text_.size() - 1)));
    return false;
  };
  if (text_.empty()) return false;
  while (true) {
    at = text_.find_first_not_of(' ', at);
    if (at == std::string::npos)
      return bad("records without an end",
                 fmt::format("no record delimiter '{}' ends the parameters", record), text_.size() - 1);
    const std::size_t start = at;
    std::size_t digits = at;
    while (is_number_start(text_, digits)) ++digits;
    Value value{{}, false, start};
    if (digits > at && digits < text_.size() && text_[digits] == 'H') {
      std::size_t length = 0;
      std::from_chars(text_.data() + at, text_.data() + digits, length);
      if (length > text_.size() - digits - 1)
        return bad("strings that run out",
                   fmt::format("a string of {} characters runs out of the record", length), start);
      value.text = std::string_view(text_).substr(digits + 1, length);
      value.is_string = true;
      at = text_.find_first_not_of(' ', digits + 1 + length);
      if (at == std::string::npos || (text_[at] != delimiter && text_[at] != record))
        return bad("strings without a delimiter", "no delimiter after a string: its count may be wrong",
                   start);
    } else {
      while (at < text_.size() && text_[at] != delimiter && text_[at] != record) ++at;
      if (at == text_.size()) continue;  // told above, with nothing but blanks left
      value.text = trimmed(std::string_view(text_).substr(start, at - start));
      if (at / width_ != start / width_ && !value.text.empty())
        findings.defect("values broken across lines",
                        fmt::format("{}: a number runs over the end of its line", what), place(start));
    }
    values_.push_back(value);
    if (text_[at++] == record) break;
  }
  end_ = at - 1;
  return true;
}

std::optional<int> Record::integer(std::size_t i, int otherwise) const {
  if (is_blank(i)) return otherwise;
  return values_[i].is_string ? std::nullopt : field_number(values_[i].text);
}

std::optional<double> Record::real(std::size_t i, double otherwise) const {
  if (is_blank(i)) return otherwise;
  if (values_[i].is_string) return std::nullopt;
  std::string text(values_[i].text);
  for (char& c : text)
    if (c == 'D' || c == 'd') c = 'E';
  const char* first = text.data() + (text[0] == '+' ? 1 : 0);
  double value = 0;
  const auto [end, code] = std::from_chars(first, text.data() + text.size(), value);
  if ((code != std::errc{} && code != std::errc::result_out_of_range) || end != text.data() + text.size() ||
      !std::all_of(text.begin(), text.end(), [](char c) {
        return (c >= '0' && c <= '9') || c == '.' || c == '+' || c == '-' || c == 'E' || c == 'e';
      }))
    return std::nullopt;
  return value;
}

}  // namespace structure

void check_structure(const Source& source, Findings& findings) {
  structure::RawFile file;
  structure::LineCheck(file, findings).run(source.bytes());
  structure::Bounds bounds = structure::check_global(file, findings);
  const structure::Directory directory = structure::check_directory(file, findings);
  structure::check_parameters(file, directory, bounds, findings);
}

}  // namespace selvage::formats::iges
