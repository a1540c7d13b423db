// The yarns' side of a WIF: colours, spacings and thicknesses of the warp's and the weft's threads.
#pragma once

#include <string>
#include <vector>

#include "fabric/model.h"
#include "formats/wif/loom.h"

namespace selvage::formats::wif {

// The two systems of the weave, with as many yarns as the drawdown has, and the threads that they name.
// README.md says what stands for what, and what is taken where the file is silent.
struct Yarns {
  Unit units = Unit::mm;  // of every length here
  std::vector<fabric::Thread> threads;
  fabric::WeaveSystem warp, weft;
};

// `ends` and `picks` are at least 1. Whether it is any good shows in the report's errors.
Yarns read_yarns(const Ini& ini, const Loom& loom, int ends, int picks, TextReport& report);

}  // namespace selvage::formats::wif
