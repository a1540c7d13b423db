// What the command line says of IGES alone.
#pragma once

#include <vector>

#include "core/option.h"

namespace selvage::formats::iges::option {

inline constexpr Option solid = {.name = "--iges-solid",
                                 .help = "a solid (186) instead of three surfaces (128) a yarn"};
inline constexpr Option lines = {
    .name = "--iges-lines",
    .help =
        "at most so many lines a section, or as many as there are numbers for; a longer fabric is written as "
        "NAME.1.igs, NAME.2.igs, ...",
    .argument = Argument::whole(100, 9'999'999),
    .preset = "9999999"};
inline constexpr Option split_yarns = {
    .name = "--split-yarns",
    .help = "a yarn that is too long for one file is cut into several, each closed",
    .why = "cuts yarns that are whole",
    .not_with = "--cut --matrix"};

inline std::vector<const Option*> all() {
  return {&solid, &lines, &split_yarns};
}

}  // namespace selvage::formats::iges::option
