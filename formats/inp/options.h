// What the command line says of Abaqus and CalculiX decks alone.
#pragma once

#include <vector>

#include "core/option.h"

namespace selvage::formats::inp::option {

inline constexpr Option split_deck = {
    .name = "--split-deck",
    .help =
        "nodes, elements, sets and surfaces in a file of their own, NAME_mesh.inp, which NAME.inp includes"};

inline std::vector<const Option*> all() {
  return {&split_deck};
}

}  // namespace selvage::formats::inp::option
