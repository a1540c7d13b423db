#include "formats/csv/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "core/csv.h"
#include "core/number_text.h"
#include "core/text_report.h"
#include "core/words.h"

namespace selvage::formats::csv {

namespace {

using fabric::Measured;
using fabric::MeasuredYarn;

// What columns may be called; those of lengths with a unit behind it, as in x_mm.
struct Column {
  std::array<std::string_view, 4> names;
  bool is_length = false;
};
enum Which : std::size_t {
  yarn,
  section,
  point,
  x,
  y,
  z,
  width,
  height,
  radius,
  diameter,
  angle,
  parameter,
  speed,
  tangent_x,
  tangent_y,
  tangent_z,
  up_x,
  up_y,
  up_z
};
constexpr std::array<Column, 19> columns{{{{"yarn", "name", "id", "fibre"}},
                                          {{"section", "slice"}},
                                          {{"point"}},
                                          {{"x"}, true},
                                          {{"y"}, true},
                                          {{"z"}, true},
                                          {{"width"}, true},
                                          {{"height", "thickness"}, true},
                                          {{"radius"}, true},
                                          {{"diameter"}, true},
                                          {{"angle"}},
                                          {{"parameter"}},
                                          {{"speed"}, true},
                                          {{"tangent_x"}},
                                          {{"tangent_y"}},
                                          {{"tangent_z"}},
                                          {{"up_x"}},
                                          {{"up_y"}},
                                          {{"up_z"}}}};

class Reader {
 public:
  Reader(const Source& source, TextReport& report, const CsvTable& table)
      : source_(source), report_(report), table_(table) {
    at_.fill(none);
  }

  std::optional<Measured> read() {
    if (!find_columns()) return std::nullopt;
    for (std::size_t row = 0; row < table_.rows.size() && !report_.is_full(); ++row) read_row(row);
    if (table_.rows.empty()) report_.error(Spot(), "the table has no point: a row each");
    return std::move(measured_);
  }

 private:
  static constexpr std::size_t none = ~std::size_t{0};
  struct Sections {
    std::set<std::string> all;
    std::set<std::string>::iterator last;
  };
  [[nodiscard]] bool has(Which which) const { return at_[which] != none; }

  // A column's name without its unit, which is noted.
  std::string_view without_unit(std::string_view name, std::optional<Unit>& unit) const {
    const std::size_t mark = name.rfind('_');
    if (mark == std::string_view::npos) return name;
    const std::string_view end = name.substr(mark + 1);
    for (const auto& [word, value] :
         {std::pair{"mm", Unit::mm}, std::pair{"cm", Unit::cm}, std::pair{"m", Unit::m},
          std::pair{"um", Unit::um}, std::pair{"inch", Unit::inch}, std::pair{"in", Unit::inch}})
      if (same_word(end, word)) {
        unit = value;
        return name.substr(0, mark);
      }
    return name;
  }

  bool find_columns() {
    std::string_view first_length;
    std::optional<std::optional<Unit>> of_all;
    for (std::size_t c = 0; c < table_.columns.size(); ++c) {
      std::optional<Unit> unit;
      const std::string_view given = table_.columns[c], plain = without_unit(given, unit);
      for (std::size_t k = 0; k < columns.size(); ++k) {
        const auto is_it = [&](std::string_view name) {
          return !name.empty() && same_word(name, columns[k].is_length ? plain : given);
        };
        if (std::none_of(columns[k].names.begin(), columns[k].names.end(), is_it)) continue;
        if (at_[k] != none) return head_error(fmt::format("two columns say the {}", columns[k].names[0]));
        at_[k] = c;
        if (!columns[k].is_length) continue;
        if (of_all && *of_all != unit)
          return head_error(fmt::format("the columns {} and {} have different units", in_quotes(first_length),
                                        in_quotes(given)));
        of_all = unit;
        first_length = given;
      }
    }
    std::string missing;
    for (const Which which : {x, y, z})
      if (!has(which)) missing += fmt::format("{}{}", missing.empty() ? "" : ", ", columns[which].names[0]);
    if (!missing.empty())
      return head_error(
          fmt::format("columns are missing: {}; the first row names them, as in yarn,x,y,z,radius "
                      "(lengths perhaps with their unit: x_mm)",
                      missing));
    if (has(width) != has(height))
      return head_error("width and height go together: a round yarn has a radius");
    measured_.units = *of_all;
    return true;
  }
  bool head_error(std::string text) {
    report_.error(spot_at(source_, {std::max(table_.head_line, 1), 1}), std::move(text));
    return false;
  }

  [[nodiscard]] TextPlace place(std::size_t row, Which which) const {
    return {table_.lines[row], table_.places[row][at_[which]]};
  }
  void refuse(std::size_t row, Which which, std::string text) {
    good_ = false;
    report_.error(spot_at(source_, place(row, which)), std::move(text));
  }

  double number(std::size_t row, Which which) {
    const std::string& text = table_.rows[row][at_[which]];
    const std::optional<double> value = read_number(text);
    if (value) return *value;
    refuse(row, which,
           fmt::format("{} is not a number: the column {} has finite decimal numbers with a point",
                       in_quotes(text), in_quotes(table_.columns[at_[which]])));
    return 0.0;
  }
  double positive(std::size_t row, Which which) {
    const double value = number(row, which);
    if (good_ && !(value > 0.0))
      refuse(row, which, fmt::format("the {} has to be larger than 0", columns[which].names[0]));
    return value;
  }
  Vec3 vector(std::size_t row, Which first) {
    Vec3 vector;
    for (std::size_t i = 0; i < 3; ++i)
      vector[static_cast<Eigen::Index>(i)] = number(row, static_cast<Which>(first + i));
    return vector;
  }

  MeasuredYarn& yarn_of(std::size_t row) {
    const std::string name = has(yarn) ? table_.rows[row][at_[yarn]] : "yarn_1";
    if (has(yarn) && name.empty()) refuse(row, yarn, "the yarn's name is empty");
    const auto [found, is_new] = numbers_.try_emplace(name, measured_.yarns.size());
    if (is_new) {
      measured_.yarns.emplace_back().name = name;
      last_.emplace_back();
    }
    return measured_.yarns[found->second];
  }

  // The outline that a point belongs to; those of a yarn stand one after the other.
  void take_section(std::size_t row, MeasuredYarn& of, std::size_t number) {
    const std::string& id = table_.rows[row][at_[section]];
    Sections& seen = sections_[number];
    if (!seen.all.empty() && *seen.last == id) return;
    const auto [place, is_new] = seen.all.insert(id);
    if (!is_new)
      refuse(row, section,
             fmt::format("section {} has points further up: the rows of a section stand together",
                         in_quotes(id)));
    seen.last = place;
    of.sections.push_back(of.points.size());
  }

  // Numbers that count the points along a yarn.
  void check_order(std::size_t row, std::size_t number) {
    std::array<std::optional<double>, 2>& last = last_[number];
    for (const auto& [which, k] : {std::pair{point, std::size_t{0}}, std::pair{parameter, std::size_t{1}}}) {
      if (!has(which)) continue;
      const double value = this->number(row, which);
      if (good_ && last[k] && value <= *last[k])
        refuse(row, which,
               fmt::format("points out of order: the {} is {} after {}; sort the rows of each yarn",
                           columns[which].names[0], value, *last[k]));
      last[k] = value;
    }
  }

  void read_row(std::size_t row) {
    good_ = true;
    MeasuredYarn& of = yarn_of(row);
    const auto number = static_cast<std::size_t>(&of - measured_.yarns.data());
    check_order(row, number);
    if (has(section)) take_section(row, of, number);
    of.points.push_back(vector(row, x));
    of.places.push_back(place(row, x));
    if (has(section)) return;
    std::optional<fabric::SizeAt> size;
    if (has(width))
      size = fabric::SizeAt{positive(row, width), positive(row, height), std::nullopt};
    else if (has(radius) || has(diameter)) {
      const double across = has(diameter) ? positive(row, diameter) : 2.0 * positive(row, radius);
      size = fabric::SizeAt{across, across, std::nullopt};
    }
    if (size && has(angle)) size->angle = this->number(row, angle);
    if (size) of.sizes.push_back(size);
    if (has(parameter) && has(speed) && has(tangent_x) && has(tangent_y) && has(tangent_z)) {
      of.parameters.push_back(this->number(row, parameter));
      of.derivatives.push_back(positive(row, speed) * vector(row, tangent_x));
    }
    if (has(up_x) && has(up_y) && has(up_z)) {
      of.ups.push_back(vector(row, up_x));
      if (good_ && of.ups.back().squaredNorm() == 0.0) refuse(row, up_x, "this direction is zero");
    }
  }

  const Source& source_;
  TextReport& report_;
  const CsvTable& table_;
  std::array<std::size_t, columns.size()> at_{};  // of each column in the table
  Measured measured_;
  std::map<std::string, std::size_t> numbers_;              // of the yarns, by name
  std::map<std::size_t, Sections> sections_;                // of each yarn
  std::vector<std::array<std::optional<double>, 2>> last_;  // point and parameter of each yarn
  bool good_ = true;
};

}  // namespace

std::optional<Measured> read_points(const Source& source, Diagnostics& diagnostics) {
  return reported(source, diagnostics, [](const Source& text, TextReport& report) -> std::optional<Measured> {
    const Result<CsvTable> table = read_csv(text.bytes());
    if (table) return Reader(text, report, *table).read();
    report.error(spot_at(text, table.error().place), table.error().text);
    return std::nullopt;
  });
}

}  // namespace selvage::formats::csv
