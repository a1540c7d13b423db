// What the command line says of STEP alone.
#pragma once

#include <vector>

#include "core/option.h"

namespace selvage::formats::step::option {

inline constexpr Option schema = {.name = "--step-schema",
                                  .help = "the application protocol",
                                  .argument = Argument::one_of("AP242 AP214", true),
                                  .preset = "AP242"};

inline std::vector<const Option*> all() {
  return {&schema};
}

}  // namespace selvage::formats::step::option
