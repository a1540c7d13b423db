#include "formats/iges/global.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "formats/iges/real_text.h"

namespace selvage::formats::iges {

namespace {

struct UnitRow {
  int flag;
  std::array<std::string_view, 2> names;   // of the standard
  std::array<std::string_view, 2> others;  // that programs write
  Unit unit;                               // in which lengths of the file are kept
  double factor;                           // to it

  [[nodiscard]] bool is_named(std::string_view name) const { return name == names[0] || name == names[1]; }
};
constexpr std::array<UnitRow, 10> unit_rows = {
    {{1, {"INCH", "IN"}, {"INCHES", "INCHES"}, Unit::inch, 1},
     {2, {"MM", "MM"}, {"MILLIMETER", "MILLIMETRE"}, Unit::mm, 1},
     {4, {"FT", "FT"}, {"FOOT", "FEET"}, Unit::mm, 304.8},
     {5, {"MI", "MI"}, {"MILE", "MILES"}, Unit::mm, 1609344},
     {6, {"M", "M"}, {"METER", "METRE"}, Unit::m, 1},
     {7, {"KM", "KM"}, {"KILOMETER", "KILOMETRE"}, Unit::mm, 1e6},
     {8, {"MIL", "MIL"}, {"MILS", "THOU"}, Unit::mm, 0.0254},
     {9, {"UM", "UM"}, {"MICRON", "MICRONS"}, Unit::um, 1},
     {10, {"CM", "CM"}, {"CENTIMETER", "CENTIMETRE"}, Unit::cm, 1},
     {11, {"UIN", "UIN"}, {"MICROINCH", "UINCH"}, Unit::mm, 0.0000254}}};

const UnitRow* row_of(std::int64_t flag) {
  const auto* const found = std::find_if(unit_rows.begin(), unit_rows.end(),
                                         [flag](const UnitRow& row) { return row.flag == flag; });
  return found == unit_rows.end() ? nullptr : found;
}

const UnitRow* row_named(std::string_view name) {
  for (const UnitRow& row : unit_rows)
    if (row.is_named(name) || name == row.others[0] || name == row.others[1]) return &row;
  return nullptr;
}

// YYYYMMDD.HHNNSS, or of older versions YYMMDD.HHNNSS; nothing for anything else.
std::string date_of(const std::string& text) {
  const auto has_form = [](std::string_view date) {
    for (std::size_t i = 0; i < date.size(); ++i) {
      const bool is_point = i + 7 == date.size();
      if (is_point ? date[i] != '.' : !is_digit(date[i])) return false;
    }
    return true;
  };
  if (text.size() == 15 && has_form(text)) return text;
  if (text.size() == 13 && has_form(text)) return (text[0] >= '7' ? "19" : "20") + text;
  return {};
}

// A month, a day and a time that there are, in the form of date_of().
bool is_date(std::string_view date) {
  const auto two = [&](std::size_t from_end) {
    const std::string_view digits = date.substr(date.size() - from_end, 2);
    return 10 * (digits[0] - '0') + digits[1] - '0';
  };
  return !date.empty() && two(11) >= 1 && two(11) <= 12 && two(9) >= 1 && two(9) <= 31 && two(6) <= 24 &&
         two(4) < 60 && two(2) < 60;
}

// The parameters behind the delimiters: value i is parameter i + 3.
class GlobalReader {
 public:
  GlobalReader(const Values& values, Complaints& complaints) : values_(values), complaints_(complaints) {}

  Global run() {
    Global global;
    take_names(global);
    take_units(global);
    if (integer(16, 1, false) < 1) warning(16, "the number of line weights is not positive");
    global.date = date(18);
    take_ranges(global);
    text(21);  // author
    text(22);  // organization
    const std::int64_t version = integer(23, 3), drafting = integer(24);
    if (version < 1 || version > last_version)
      warning(23, fmt::format("there is no version {}: IGES 5.3 is 11", version));
    if (drafting < 0 || drafting > last_drafting)
      warning(24, fmt::format("there is no drafting standard {}: they are 0 to 7", drafting));
    date(25);  // of the last change
    text(26);  // protocol
    if (values_.size() > 24)
      complaints_.flaw(spot(27),
                       fmt::format("the global section has {} parameters; there are 26", values_.size() + 2));
    return global;
  }

 private:
  static constexpr int last_version = 11, last_drafting = 7;

  void take_names(Global& global) {
    constexpr std::array<std::pair<int, std::string_view>, 5> due = {
        {{3, "product"}, {4, "file name"}, {5, "native system"}, {6, "preprocessor"}, {18, "date"}}};
    for (const auto& [number, name] : due)
      if (is_blank(number))
        warning(number,
                fmt::format("global parameter {} ({}) is not given, and has no default", number, name));
    global.product = text(3);
    global.file_name = text(4);
    global.system = text(5);
    for (const int number : {6, 12}) text(number);
    bool told = false;
    for (int number = 7; number <= 11; ++number)
      if (integer(number) <= 0 && !std::exchange(told, true))
        warning(number,
                fmt::format("global parameter {} (range of the sender's numbers) is not given", number));
  }

  void take_units(Global& global) {
    const std::int64_t flag = integer(14, 1);
    const double scale = real(13, 1);
    const std::string said = text(15);
    std::string name = said;
    for (char& c : name)
      if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    const UnitRow* const named = row_named(name);
    const UnitRow* row = flag == 3 ? named : row_of(flag);
    if (row == nullptr && flag != 3) {
      // A number that is none: the name, else what OpenCASCADE takes.
      row = named != nullptr ? named : row_of(2);
      complaints_.flaw(spot(14),
                       fmt::format("there is no unit {}: units are 1 to 11; lengths are taken as {}", flag,
                                   row->names[0]));
    }
    if (!(scale > 0)) fault(13, fmt::format("the model space scale is not positive: {}", scale));
    if (row == nullptr) {
      fault(15, fmt::format("unit 3 goes by its name, and {} is none", in_quotes(said)));
      return;
    }
    if (name.empty()) {
      if (flag != 1)
        warning(15, fmt::format("the unit's name is not given; unit {} is {}", flag, row->names[0]));
    } else if (!row->is_named(name) && flag == 3) {
      defect(15, fmt::format("unit 3 goes by its name, and {} is none of the standard", in_quotes(said)));
    } else if (!row->is_named(name)) {
      const std::string text = fmt::format("unit {} is {}, but its name is given as {}; the number holds",
                                           flag, row->names[0], in_quotes(said));
      named != nullptr&& named != row ? complaints_.flaw(spot(15), text) : defect(15, text);
    }
    global.units = row->unit;
    global.factor = row->factor;
    if (row->factor != 1)
      complaints_.reader_note(spot(14), fmt::format("lengths in {} are turned into mm", row->names[0]));
    if (!(scale > 0) || scale == 1) return;
    global.factor /= scale;
    complaints_.reader_note(
        spot(13), fmt::format("the model is drawn at the scale {}; it is brought to true size", scale));
  }

  void take_ranges(Global& global) {
    global.stated_resolution = real(19);
    global.largest = real(20);
    global.resolution_spot = spot(19);
    global.largest_spot = spot(20);
    global.resolution = std::abs(global.stated_resolution * global.factor);
    if (is_blank(19))
      warning(19, "the resolution (global parameter 19) is not given, and has no default");
    else if (!(global.stated_resolution > 0))
      warning(19, fmt::format("a resolution (global parameter 19) of {}, which states none",
                              global.stated_resolution));
    if (global.largest < 0) warning(20, "the largest coordinate (global parameter 20) is negative");
  }

  static std::size_t index(int number) { return static_cast<std::size_t>(number - 3); }
  [[nodiscard]] Spot spot(int number) const { return values_.spot(index(number)); }
  [[nodiscard]] bool is_blank(int number) const { return values_.is_blank(index(number)); }

  std::string date(int number) {
    const std::string said = text(number);
    std::string date = date_of(said);
    if (!said.empty() && !is_date(date))
      warning(number, fmt::format("{} is no date: YYYYMMDD.HHNNSS", in_quotes(said)));
    return date;
  }
  std::string text(int number) {
    if (is_blank(number)) return {};
    if (values_[index(number)].is_string) return readable(values_[index(number)].text);
    fault(number, fmt::format("global parameter {}: {} is no string (its length, H and its characters)",
                              number, in_quotes(values_[index(number)].text)));
    return {};
  }
  // A reader takes "2." for an integer. `needed`: it minds what is none at all.
  std::int64_t integer(int number, std::int64_t otherwise = 0, bool needed = true) {
    if (const std::optional<int> value = values_.integer(index(number), static_cast<int>(otherwise)))
      return *value;
    const std::optional<double> value = values_.real(index(number));
    const bool is_whole = value && std::trunc(*value) == *value && std::abs(*value) < 1e15;
    const std::string text =
        fmt::format("global parameter {}: {} is no integer", number, in_quotes(values_[index(number)].text));
    needed && !is_whole ? void(fault(number, text)) : defect(number, text);
    return is_whole ? static_cast<std::int64_t>(*value) : otherwise;
  }
  double real(int number, double otherwise = 0) {
    const std::optional<double> value = values_.real(index(number), otherwise);
    if (!value)
      fault(number, fmt::format("global parameter {}: {} is no number", number,
                                in_quotes(values_[index(number)].text)));
    return value.value_or(otherwise);
  }
  bool fault(int number, std::string what) { return complaints_.fault(spot(number), std::move(what)); }
  void defect(int number, std::string what) { complaints_.defect(spot(number), std::move(what)); }
  void warning(int number, std::string what) { complaints_.warning(spot(number), std::move(what)); }

  const Values& values_;
  Complaints& complaints_;
};

}  // namespace

UnitCode code_of(Unit unit) {
  const auto* const row = std::find_if(unit_rows.begin(), unit_rows.end(),
                                       [unit](const UnitRow& r) { return r.unit == unit && r.factor == 1; });
  return {row->flag, row->names[0]};
}

std::string readable(std::string_view bytes) {
  std::string text(bytes.substr(0, bytes.find_last_not_of(' ') + 1));
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '_';
  if (text_prefix(text) == text.size()) return text;
  std::string wide;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x80)
      wide += c;
    else if (code < 0xA0)  // control characters of Latin-1
      wide += '_';
    else
      wide.append({static_cast<char>(0xC0 | code >> 6U), static_cast<char>(0x80 | (code & 0x3FU))});
  }
  return wide;
}

Global read_global(const Lines& lines, Complaints& complaints) {
  const int count = lines.count(Section::global);
  if (count == 0) return {};  // which was said
  Parameters cursor(lines, Section::global, 1, count, {});
  Global global;
  if (!read_delimiters(cursor)) {
    complaints.fault(cursor.failure()->spot, cursor.failure()->text);
  } else if (const Values values(cursor); values.failure()) {
    complaints.fault(values.failure()->spot, "global section: " + values.failure()->text);
  } else {
    if (values.flaw()) complaints.flaw(values.flaw()->spot, "global section: " + values.flaw()->text);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (values[i].is_broken)
        complaints.fault(values[i].spot, "global section: " + broken_number(values[i].text));
    global = GlobalReader(values, complaints).run();
  }
  global.delimiters = cursor.delimiters();
  return global;
}

}  // namespace selvage::formats::iges
