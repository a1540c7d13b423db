// The colours of a WIF.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "fabric/model.h"
#include "formats/wif/values.h"

namespace selvage::formats::wif {

struct Color {
  int number = 0;                    // in [COLOR TABLE], from 1
  std::optional<yarn::Color> rgb{};  // nothing: the file does not say it
};

struct Palette {
  bool has_table = false;
  int low = 0, high = 255;            // what 0 and 255 are written as
  std::map<int, yarn::Color> colors;  // by their number
};

// [COLOR TABLE], scaled by the Range of [COLOR PALETTE].
Palette read_palette(const Ini& ini, TextReport& report);

// The colours of the first `count` threads of a system ([WARP] or [WEFT]): each thread's own, else the
// section's; no colour where the file gives none. A number that is in no table is an error where a thread has
// it, else a warning.
std::vector<std::optional<Color>> read_colors(const Ini& ini, const Section& system, const Counted& threads,
                                              std::size_t count, const Palette& palette, TextReport& report);

}  // namespace selvage::formats::wif
