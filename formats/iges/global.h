// The global section: what holds for the whole file.
#pragma once

#include <string>
#include <string_view>

#include "core/units.h"
#include "formats/iges/parameters.h"

namespace selvage::formats::iges {

struct Global {
  Delimiters delimiters;
  std::string product, file_name;      // 3, 4
  std::string system;                  // 5
  std::string date;                    // 18, YYYYMMDD.HHNNSS; empty: not given
  double stated_resolution = 0;        // 19, as in the file; 0: not given
  double resolution = 0;               // the same in `units`, not negative
  double largest = 0;                  // 20
  Spot resolution_spot, largest_spot;  // of 19 and 20

  // What coordinates of the file are multiplied by to be lengths in `units`: 1 but for a scale and for units
  // that Selvage does not have, which become mm.
  Unit units = Unit::inch;
  double factor = 1;
};

// Faults: no delimiters, a value of the wrong type, a scale or unit that is none. What is missing or is
// against the standard only a check minds. Strings are made readable text (Latin-1 becomes UTF-8, control
// characters become '_').
Global read_global(const Lines& lines, Complaints& complaints);

// What parameters 14 and 15 say of a unit.
struct UnitCode {
  int flag;
  std::string_view name;
};
UnitCode code_of(Unit unit);

// Foreign bytes as text: UTF-8 as it is, other 8-bit characters taken for Latin-1, control characters as '_';
// without blanks at the end.
std::string readable(std::string_view bytes);

}  // namespace selvage::formats::iges
