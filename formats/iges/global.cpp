#include "formats/iges/global.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace selvage::formats::iges {

namespace {

struct UnitRow {
  int flag;
  std::array<std::string_view, 3> names;
  Unit unit;      // in which lengths of the file are kept
  double factor;  // to it
};
constexpr std::array<UnitRow, 10> unit_rows = {{{1, {"INCH", "IN", "INCHES"}, Unit::inch, 1},
                                                {2, {"MM", "MILLIMETER", "MILLIMETRE"}, Unit::mm, 1},
                                                {4, {"FT", "FOOT", "FEET"}, Unit::mm, 304.8},
                                                {5, {"MI", "MILE", "MILES"}, Unit::mm, 1609344},
                                                {6, {"M", "METER", "METRE"}, Unit::m, 1},
                                                {7, {"KM", "KILOMETER", "KILOMETRE"}, Unit::mm, 1e6},
                                                {8, {"MIL", "MILS", "THOU"}, Unit::mm, 0.0254},
                                                {9, {"UM", "MICRON", "MICRONS"}, Unit::um, 1},
                                                {10, {"CM", "CENTIMETER", "CENTIMETRE"}, Unit::cm, 1},
                                                {11, {"UIN", "MICROINCH", "UINCH"}, Unit::mm, 0.0000254}}};

const UnitRow* row_of(int flag) {
  const auto* const found = std::find_if(unit_rows.begin(), unit_rows.end(),
                                         [flag](const UnitRow& row) { return row.flag == flag; });
  return found == unit_rows.end() ? nullptr : found;
}

const UnitRow* row_named(std::string name) {
  for (char& c : name)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  for (const UnitRow& row : unit_rows)
    if (std::find(row.names.begin(), row.names.end(), name) != row.names.end()) return &row;
  return nullptr;
}

// YYYYMMDD.HHNNSS, or of older versions YYMMDD.HHNNSS; nothing for anything else.
std::string date_of(const std::string& text) {
  const auto has_form = [](std::string_view date) {
    for (std::size_t i = 0; i < date.size(); ++i) {
      const bool is_point = i + 7 == date.size();
      if (is_point ? date[i] != '.' : (date[i] < '0' || date[i] > '9')) return false;
    }
    return true;
  };
  if (text.size() == 15 && has_form(text)) return text;
  if (text.size() == 13 && has_form(text)) return (text[0] >= '7' ? "19" : "20") + text;
  return {};
}

void take_units(Global& global, const Spot& flag, const Spot& scale, TextReport& report) {
  const bool by_name = global.unit_flag == 3;
  const UnitRow* const row = by_name ? row_named(global.unit_name) : row_of(global.unit_flag);
  if (row == nullptr) {
    report.error(flag, by_name ? fmt::format("no unit of length is named {}", in_quotes(global.unit_name))
                               : fmt::format("there is no unit {}: units are 1 to 11", global.unit_flag));
    return;
  }
  const UnitRow* const named = row_named(global.unit_name);
  if (named != nullptr && named != row)
    report.warning(flag, fmt::format("unit {} is {}, but its name is given as {}; the number holds",
                                     row->flag, row->names[0], in_quotes(global.unit_name)));
  global.units = row->unit;
  global.factor = row->factor;
  if (row->factor != 1) report.note(flag, fmt::format("lengths in {} are turned into mm", row->names[0]));
  if (global.scale == 1) return;
  if (!(global.scale > 0)) {
    report.error(scale, fmt::format("a model space scale cannot be {}", global.scale));
    return;
  }
  global.factor /= global.scale;
  report.note(scale,
              fmt::format("the model is drawn at the scale {}; it is brought to true size", global.scale));
}

}  // namespace

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

std::optional<Global> read_global(const Lines& lines, TextReport& report) {
  const int count = lines.count(Section::global);
  if (count == 0) {
    report.error(lines.end(), "there is no global section");
    return std::nullopt;
  }
  Parameters cursor(lines, Section::global, 1, count, {});
  Global global;
  const auto text = [&cursor] { return readable(cursor.text()); };
  if (const std::optional<Delimiters> delimiters = read_delimiters(cursor)) {
    global.delimiters = *delimiters;
    global.product = text();
    global.file_name = text();
    global.system = text();
    global.preprocessor = text();
    for (int i = 7; i <= 11; ++i) cursor.integer();  // number ranges of the sender
    global.receiver = text();
    global.scale = cursor.real(1);
    const Spot scale = cursor.spot();
    const auto flag_value = cursor.integer(1);
    const Spot flag = cursor.spot();
    global.unit_flag = flag_value >= 1 && flag_value <= 11 ? static_cast<int>(flag_value) : 0;
    global.unit_name = text();
    cursor.skip();  // 16, 17: line weights
    cursor.skip();
    global.date = date_of(text());
    global.resolution = cursor.real();
    global.largest = cursor.real();
    global.author = text();
    global.organization = text();
    global.version = static_cast<int>(std::clamp<std::int64_t>(cursor.integer(3), 1, 99));
    global.drafting = static_cast<int>(std::clamp<std::int64_t>(cursor.integer(), 0, 99));
    global.modified = date_of(text());
    global.protocol = text();
    if (cursor.ok()) {
      if (!cursor.at_end()) report.warning(cursor.spot(), "the global section has more than 26 parameters");
      take_units(global, flag, scale, report);
      global.resolution = std::abs(global.resolution * global.factor);
    }
  }
  if (!cursor.ok()) report.error(cursor.failure()->spot, cursor.failure()->text);
  if (report.errors() > 0) return std::nullopt;
  return global;
}

}  // namespace selvage::formats::iges
