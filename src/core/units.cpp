#include "core/units.h"

namespace selvage {

std::string_view name_of(Unit unit) {
  switch (unit) {
    case Unit::m:
      return "m";
    case Unit::cm:
      return "cm";
    case Unit::mm:
      return "mm";
    case Unit::um:
      return "um";
    case Unit::inch:
      return "inch";
  }
  return "mm";
}

std::optional<Unit> unit_named(std::string_view word) {
  for (Unit unit : all_units)
    if (name_of(unit) == word) return unit;
  return std::nullopt;
}

double millimetres_per(Unit unit) {
  switch (unit) {
    case Unit::m:
      return 1000.0;
    case Unit::cm:
      return 10.0;
    case Unit::mm:
      return 1.0;
    case Unit::um:
      return 0.001;
    case Unit::inch:
      return 25.4;
  }
  return 1.0;
}

}  // namespace selvage
