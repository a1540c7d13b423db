// What the text of a number may name: units, and the params of the file.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"
#include "core/units.h"
#include "formats/txt/expression.h"

namespace selvage::formats::txt {

struct NumberUnit {
  std::string_view word;
  Measure measure = Measure::plain;
  double size = 1;  // in millimetres, degrees, g/cm3, MPa, turns per metre, 1/K, W/(m K), mm2/s
};
inline constexpr std::array<NumberUnit, 25> number_units = {{{"mm", Measure::length, 1.0},
                                                             {"cm", Measure::length, 10.0},
                                                             {"dm", Measure::length, 100.0},
                                                             {"m", Measure::length, 1000.0},
                                                             {"um", Measure::length, 0.001},
                                                             {"in", Measure::length, 25.4},
                                                             {"inch", Measure::length, 25.4},
                                                             {"deg", Measure::angle, 1.0},
                                                             {"rad", Measure::angle, 57.295779513082323},
                                                             {"g/cm3", Measure::density, 1.0},
                                                             {"kg/m3", Measure::density, 0.001},
                                                             {"MPa", Measure::modulus, 1.0},
                                                             {"GPa", Measure::modulus, 1000.0},
                                                             {"kPa", Measure::modulus, 0.001},
                                                             {"Pa", Measure::modulus, 1e-6},
                                                             {"N/mm2", Measure::modulus, 1.0},
                                                             {"cN/mm2", Measure::modulus, 0.01},
                                                             {"tpm", Measure::twist, 1.0},
                                                             {"tpi", Measure::twist, 39.370078740157481},
                                                             {"/K", Measure::expansion, 1.0},
                                                             {"W/mK", Measure::conductivity, 1.0},
                                                             {"mW/mK", Measure::conductivity, 0.001},
                                                             {"mm2/s", Measure::diffusivity, 1.0},
                                                             {"cm2/s", Measure::diffusivity, 100.0},
                                                             {"m2/s", Measure::diffusivity, 1e6}}};

class Scope {
 public:
  // Of lengths in the file. False: a unit was used before, so that it comes too late.
  [[nodiscard]] bool set_unit(Unit unit);

  // The value of a number, a number with a unit, or an expression (not empty). None: it is none of these.
  // Errors (malformed): what is wrong with it.
  std::optional<Result<double>> value(std::string_view text, Measure measure);

  // Is this the first word of a row, since a param is its beginning?
  [[nodiscard]] bool begins_with_param(std::string_view text) const;

  // `line`: where the param stands. A name that is there already: its line comes back.
  std::optional<int> define(std::string_view name, double value, bool is_count, int line);
  // Is this so many on a length (26/cm)?
  [[nodiscard]] bool is_count(std::string_view text) { return count_on_length(text).has_value(); }
  // Is this a number with a unit of lengths (0.42mm)?
  [[nodiscard]] static bool is_length(std::string_view text);
  [[nodiscard]] std::vector<std::string_view> names() const;
  // The unit of that name, if such a number takes it; null: there is none.
  static const NumberUnit* unit_of(std::string_view word, Measure measure);
  // What a number with this unit is multiplied by; of lengths in the file's unit.
  double size_of(const NumberUnit& unit) {
    has_used_unit_ = has_used_unit_ || unit.measure == Measure::length;
    return in_file_units(unit);
  }

 private:
  struct Count {
    std::string_view number;
    double length = 0;  // file units
  };
  [[nodiscard]] double in_file_units(const NumberUnit& unit) const;
  std::optional<Result<double>> with_unit(std::string_view text, Measure measure);
  [[nodiscard]] std::optional<Count> count_on_length(std::string_view text);
  [[nodiscard]] bool is_expression(std::string_view text) const;
  Result<double> expression(std::string_view text, Measure measure);
  [[nodiscard]] Status check_names(std::string_view text, Measure measure) const;

  struct Param {
    bool is_count = false;
    int line = 0;
  };
  Unit unit_ = Unit::mm;
  bool has_used_unit_ = false;
  std::vector<NamedValue> values_;
  std::vector<Param> params_;  // of each
};

// Words that no param may have for its name: those of units, those that begin statements, functions.
bool is_reserved(std::string_view word);
// That an expression may call, "sqrt".
std::span<const std::string_view> function_names();
// Is it a name that can stand in an expression: letters, digits and `_`, no digit first?
bool is_identifier(std::string_view text);

}  // namespace selvage::formats::txt
