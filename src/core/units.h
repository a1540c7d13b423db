// Units of length. A fabric keeps the unit of its file, and IGES and STEP are written in it: a scaling would
// cost bits. Reports and meshes are in mm, N, MPa and tonne.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace selvage {

enum class Unit { m, cm, mm, um, inch };

inline constexpr std::array<Unit, 5> all_units = {Unit::m, Unit::cm, Unit::mm, Unit::um, Unit::inch};

// The unit's word in Fabric TXT: "m", "cm", "mm", "um", "inch".
std::string_view name_of(Unit unit);

// Tenths of a micrometre in one unit: a whole number.
std::int64_t exact_size(Unit unit);
// Millimetres in one unit: 1000, 10, 1, 0.001, 25.4.
double millimetres_per(Unit unit);

// What a number in a text measures. `plain`: nothing that has a unit; `pitch`: a distance, or how many stand
// on a length; `any`: what it is used for tells.
enum class Measure {
  plain,
  length,
  pitch,
  angle,
  density,
  modulus,
  twist,
  expansion,
  conductivity,
  diffusivity,
  any
};

}  // namespace selvage
