// The loom's side of a WIF: which warps lie on top of which wefts.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/wif/values.h"

namespace selvage::formats::wif {

// What [WEAVING], [WARP] and [WEFT] say of the numbers.
struct Loom {
  Counted warp{"thread"}, weft{"thread"};
  Counted shafts{.noun = "shaft", .is_soft = true}, treadles{.noun = "treadle", .is_soft = true};
  bool is_rising = true;  // a moved shaft goes up
};

// Reports sections that are missing and counts that are none; the numbers not given are most_threads.
Loom read_loom(const Ini& ini, TextReport& report);

// The drawdown from THREADING with LIFTPLAN, or with TIEUP and TREADLING: one row a pick from pick 1, one
// sign an end from thread 1, '1' where the warp is on top: where one of the end's shafts is up. It reaches to
// the last pick and the last thread that have an entry. Nothing after an error.
std::optional<std::vector<std::string>> read_drawdown(const Ini& ini, const Loom& loom, TextReport& report);

}  // namespace selvage::formats::wif
