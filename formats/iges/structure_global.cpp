// The global section against the standard and against itself.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cfloat>

#include "core/text_report.h"
#include "formats/iges/structure_file.h"

namespace selvage::formats::iges::structure {

namespace {

constexpr std::size_t width = 72;
constexpr int last_flag = 11, last_version = 11, last_drafting = 7;

// By flag: the names of the standard.
constexpr std::array<std::array<std::string_view, 2>, last_flag + 1> unit_names = {{{"", ""},
                                                                                    {"INCH", "IN"},
                                                                                    {"MM", "MM"},
                                                                                    {"", ""},
                                                                                    {"FT", "FT"},
                                                                                    {"MI", "MI"},
                                                                                    {"M", "M"},
                                                                                    {"KM", "KM"},
                                                                                    {"MIL", "MIL"},
                                                                                    {"UM", "UM"},
                                                                                    {"CM", "CM"},
                                                                                    {"UIN", "UIN"}}};

// Digits, signs and letters of numbers and strings cannot part them.
bool may_delimit(char c) {
  return c > ' ' && c <= '~' && std::string_view("0123456789+-.DEH").find(c) == std::string_view::npos;
}

// The two delimiters, which come first; the offset behind them, or nothing.
std::optional<std::size_t> read_delimiters(RawFile& file, const Record& record, Findings& findings) {
  const std::string& text = record.text();
  const auto bad = [&](std::size_t at, std::string what) {
    findings.defect("delimiters", std::move(what), record.place(at));
    return std::nullopt;
  };
  std::size_t at = 0;
  if (text.starts_with("1H")) {
    file.delimiter = text[2];
    at = 3;
  }
  if (at >= text.size() || text[at] != file.delimiter)
    return bad(at, "the global section does not begin with the parameter delimiter (1H,, or nothing)");
  ++at;
  if (text.compare(at, 2, "1H") == 0) {
    file.record = text[at + 2];
    at += 3;
  }
  if (text[at] != file.delimiter && text[at] != file.record)
    return bad(at, "no delimiter after the record delimiter");
  for (const char c : {file.delimiter, file.record})
    if (!may_delimit(c)) return bad(0, fmt::format("{} cannot be a delimiter", in_quotes({&c, 1})));
  if (file.delimiter == file.record) return bad(0, "both delimiters are the same character");
  return at + 1;
}

bool is_date(std::string_view text) {
  if (text.size() != 15 && text.size() != 13) return false;
  if (text[text.size() - 7] != '.') return false;
  std::string digits;
  for (const char c : text)
    if (c >= '0' && c <= '9') digits += c;
  if (digits.size() + 1 != text.size()) return false;
  const auto two = [&](std::size_t from_end) {
    return 10 * (digits[digits.size() - from_end] - '0') + digits[digits.size() - from_end + 1] - '0';
  };
  return two(10) >= 1 && two(10) <= 12 && two(8) >= 1 && two(8) <= 31 && two(6) <= 24 && two(4) < 60 &&
         two(2) < 60;
}

class GlobalCheck {
 public:
  // Value i of `record` is parameter i + 3.
  GlobalCheck(const Record& record, Findings& findings) : record_(record), findings_(findings) {}

  Bounds run() {
    for (const int number : {3, 4, 5, 6, 18})
      if (record_.is_blank(index(number)))
        warning(number, fmt::format("global parameter {} ({}) is not given, and has no default", number,
                                    number == 3   ? "product"
                                    : number == 4 ? "file name"
                                    : number == 5 ? "native system"
                                    : number == 6 ? "preprocessor"
                                                  : "date"));
    for (int number = 7; number <= 11; ++number)
      if (integer(number) <= 0) {
        warning(number,
                fmt::format("global parameter {} (range of the sender's numbers) is not given", number));
        break;
      }
    if (!(real(13, 1) > 0)) defect(13, "the model space scale is not positive");
    check_units();
    if (integer(16, 1) < 1) defect(16, "the number of line weights is not positive");
    for (const int number : {18, 25})
      if (!record_.is_blank(index(number)) && !is_date(record_.string(index(number))))
        warning(number, fmt::format("{} is no date: YYYYMMDD.HHNNSS", in_quotes(text(number))));
    if (integer(23, 3) < 1 || integer(23, 3) > last_version)
      defect(23, fmt::format("there is no version {}: IGES 5.3 is 11", integer(23, 3)));
    if (integer(24) < 0 || integer(24) > last_drafting)
      defect(24, fmt::format("there is no drafting standard {}: they are 0 to 7", integer(24)));
    if (record_.values().size() > 24)
      defect(27,
             fmt::format("the global section has {} parameters; there are 26", record_.values().size() + 2));
    Bounds bounds;
    bounds.resolution = real(19);
    bounds.resolution_line = place(19).line;
    bounds.largest = real(20);
    bounds.largest_line = place(20).line;
    if (record_.is_blank(index(19)))
      warning(19, "the resolution (global parameter 19) is not given, and has no default");
    else if (!(bounds.resolution > 0))
      defect(19, fmt::format("a resolution (global parameter 19) of {}", bounds.resolution));
    if (bounds.largest < 0) defect(20, "the largest coordinate (global parameter 20) is negative");
    return bounds;
  }

 private:
  void check_units() {
    const int flag = integer(14, 1);
    if (flag < 1 || flag > last_flag) {
      defect(14, fmt::format("there is no unit {}: they are 1 to 11", flag));
      return;
    }
    std::string name(record_.string(index(15)));
    for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    const auto& own = unit_names[static_cast<std::size_t>(flag)];
    if (flag == 3) {
      const bool known = std::any_of(unit_names.begin() + 1, unit_names.end(), [&](const auto& row) {
        return !name.empty() && (row[0] == name || row[1] == name);
      });
      if (!known) defect(15, fmt::format("unit 3 goes by its name, and {} is none", in_quotes(name)));
    } else if (name.empty()) {
      if (flag != 1) warning(15, fmt::format("the unit's name is not given; unit {} is {}", flag, own[0]));
    } else if (name != own[0] && name != own[1]) {
      defect(15, fmt::format("unit {} is {}, but its name is given as {}", flag, own[0], in_quotes(name)));
    }
  }

  static std::size_t index(int number) { return static_cast<std::size_t>(number - 3); }
  [[nodiscard]] TextPlace place(int number) const { return record_.place_of(index(number)); }
  [[nodiscard]] std::string_view text(int number) const {
    return index(number) < record_.values().size() ? record_.values()[index(number)].text
                                                   : std::string_view{};
  }
  int integer(int number, int otherwise = 0) {
    const std::optional<int> value = record_.integer(index(number), otherwise);
    if (!value)
      defect(number, fmt::format("global parameter {} is no integer: {}", number, in_quotes(text(number))));
    return value.value_or(otherwise);
  }
  double real(int number, double otherwise = 0) {
    const std::optional<double> value = record_.real(index(number), otherwise);
    if (!value)
      defect(number, fmt::format("global parameter {} is no number: {}", number, in_quotes(text(number))));
    return value.value_or(otherwise);
  }
  void defect(int number, std::string what) {
    findings_.defect("faults of the global section", std::move(what), place(number));
  }
  void warning(int number, std::string what) {
    findings_.warning("faults of the global section", std::move(what), place(number));
  }

  const Record& record_;
  Findings& findings_;
};

}  // namespace

Bounds check_global(RawFile& file, Findings& findings) {
  if (file.global().empty()) return {};
  Record record(file.global(), 0, file.global().size(), width);
  const std::optional<std::size_t> at = read_delimiters(file, record, findings);
  if (!at) return {};
  if (record.text()[*at - 1] != file.record &&
      !record.split(file.delimiter, file.record, "global section", findings, *at))
    return {};
  return GlobalCheck(record, findings).run();
}

}  // namespace selvage::formats::iges::structure
