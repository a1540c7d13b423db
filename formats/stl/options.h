// What the command line says of STL alone.
#pragma once

#include <vector>

#include "core/option.h"

namespace selvage::formats::stl::option {

inline constexpr Option ascii = {.name = "--stl-ascii",
                                 .help = "as text, with a named solid for each yarn, instead of binary"};

inline std::vector<const Option*> all() {
  return {&ascii};
}

}  // namespace selvage::formats::stl::option
