#include "formats/iges/header.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "formats/iges/global.h"
#include "formats/iges/records.h"

namespace selvage::formats::iges {

namespace {

constexpr std::size_t columns = 72;  // of a start or global line
constexpr std::string_view part_words = ": B-spline yarns, file ";

void add_line(std::string& bytes, std::string_view data, char section, int number) {
  fmt::format_to(std::back_inserter(bytes), "{:<72}{}{:>7}\n", data, section, number);
}

std::string hollerith(std::string_view text) {
  return text.empty() ? std::string() : fmt::format("{}H{}", text.size(), text);
}

std::string real(double value) {
  std::array<char, max_number_length> buffer;
  return {buffer.data(), write_pointed(buffer.data(), value)};
}

// Fills lines of 72 columns with parameters; only strings may run over the end of a line.
class GlobalLines {
 public:
  explicit GlobalLines(std::string& bytes) : bytes_(&bytes) {}

  void put(std::string token, char delimiter = ',') {
    token += delimiter;
    if (line_.size() + token.size() > columns) close();
    for (; token.size() > columns; token.erase(0, columns)) {
      line_ = token.substr(0, columns);
      close();
    }
    line_ += token;
  }
  void close() {
    if (line_.empty()) return;
    add_line(*bytes_, line_, 'G', ++count_);
    line_.clear();
  }
  [[nodiscard]] int count() const { return count_; }

 private:
  std::string* bytes_;
  std::string line_;
  int count_ = 0;
};

// The power of ten at or below `value`, `steps` steps up. Exactly the double nearest to it, which std::pow
// need not give.
double power_of_ten_below(double value, int steps = 0) {
  const std::string text = fmt::format("1e{}", static_cast<int>(std::floor(std::log10(value))) + steps);
  double power = 0;
  std::from_chars(text.data(), text.data() + text.size(), power);
  return power;
}

}  // namespace

std::string ascii(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xC0U) == 0x80U) continue;  // the rest of a character that has its '_' already
    out += byte >= 0x20 && byte < 0x7F ? c : '_';
  }
  return out;
}

HeaderText header_text(const Header& header) {
  HeaderText text;
  const std::string file_name = ascii(header.file_name);
  const std::string title = ascii(header.title);
  const std::string prologue =
      header.part ? fmt::format("Selvage " SELVAGE_VERSION "{}{} of {}, set {}.", part_words,
                                header.part->number, header.part->count, header.part->set)
                  : "Selvage " SELVAGE_VERSION ": a closed B-spline body a yarn, a trimmed plane a piece.";
  add_line(text.bytes, prologue, 'S', ++text.start_lines);
  for (std::string_view rest = title; !rest.empty(); rest.remove_prefix(std::min(columns, rest.size())))
    add_line(text.bytes, rest.substr(0, columns), 'S', ++text.start_lines);

  const std::string product = title.empty() ? file_name : title;
  const UnitCode unit = code_of(header.units);
  GlobalLines lines(text.bytes);
  lines.put("1H,");                                       // 1 parameter delimiter
  lines.put("1H;");                                       // 2 record delimiter
  lines.put(hollerith(product));                          // 3 product identification of the sender
  lines.put(hollerith(file_name));                        // 4 file name
  lines.put(hollerith("Selvage"));                        // 5 native system
  lines.put(hollerith("Selvage " SELVAGE_VERSION));       // 6 preprocessor
  lines.put("32");                                        // 7 bits of an integer
  lines.put(std::to_string(FLT_MAX_10_EXP));              // 8 single precision: largest power of ten
  lines.put(std::to_string(FLT_DIG));                     // 9 and significant digits
  lines.put(std::to_string(DBL_MAX_10_EXP));              // 10 double precision
  lines.put(std::to_string(DBL_DIG));                     // 11
  lines.put(hollerith(product));                          // 12 product identification for the receiver
  lines.put("1.");                                        // 13 model space scale
  lines.put(std::to_string(unit.flag));                   // 14 unit
  lines.put(hollerith(unit.name));                        // 15 its name
  lines.put("1");                                         // 16 number of line weights
  lines.put(real(0.25 / millimetres_per(header.units)));  // 17 width of the widest: 0.25 mm
  lines.put(hollerith(header.time));                      // 18 written on
  lines.close();  // 19 and 20 are put in at the end: always a line of their own
  lines.put(real(header.resolution));
  lines.put(real(header.largest));
  lines.close();
  lines.put("");                      // 21 author: not given
  lines.put("");                      // 22 organization: not given
  lines.put("11");                    // 23 version 5.3
  lines.put("0");                     // 24 drafting standard: none
  lines.put(hollerith(header.time));  // 25 model changed on
  lines.put("", ';');                 // 26 application protocol: none
  lines.close();
  text.global_lines = lines.count();
  return text;
}

std::optional<PartMark> part_mark(std::string_view head) {
  std::string_view rest = head.substr(0, columns);
  constexpr std::string_view maker = "Selvage ", between = " of ", set_word = ", set ";
  const std::size_t words = rest.find(part_words);
  if (!rest.starts_with(maker) || words == std::string_view::npos) return std::nullopt;
  rest.remove_prefix(words + part_words.size());
  PartMark mark;
  const auto take_number = [&rest](int& number, std::string_view after) {
    const auto [end, failure] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
    if (failure != std::errc() || number < 1) return false;
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    if (!rest.starts_with(after)) return false;
    rest.remove_prefix(after.size());
    return true;
  };
  if (!take_number(mark.number, between) || !take_number(mark.count, set_word)) return std::nullopt;
  mark.set = rest.substr(0, rest.find('.'));
  if (mark.number > mark.count || mark.count > most_files || mark.set.empty()) return std::nullopt;
  return mark;
}

std::string terminate_text(const HeaderText& header, std::int64_t directory_lines,
                           std::int64_t parameter_lines) {
  std::string bytes;
  add_line(bytes,
           fmt::format("S{:>7}G{:>7}D{:>7}P{:>7}", header.start_lines, header.global_lines, directory_lines,
                       parameter_lines),
           'T', 1);
  return bytes;
}

double resolution_for(double smallest_size, double largest, double known) {
  constexpr double usual = 1e-5, useful = 1e-7, most = 1e-3;
  if (!(smallest_size > 0)) return 1e-6;
  double resolution = power_of_ten_below(usual * smallest_size);
  if (useful < most * smallest_size) resolution = std::max(resolution, useful);
  constexpr double share_of_others = 0.01;
  if (known > resolution)
    resolution = std::max(resolution, std::min(known, power_of_ten_below(share_of_others * smallest_size)));
  const double rounding = 16 * DBL_EPSILON * largest;
  if (rounding > resolution) resolution = power_of_ten_below(rounding, 1);
  return resolution;
}

}  // namespace selvage::formats::iges
