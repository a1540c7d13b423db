// Where a yarn is divided along its way: as seldom as its bends, and the changes of its section, allow.
#pragma once

#include <span>
#include <vector>

#include "yarn/body.h"

namespace selvage::fem {

struct StationRules {
  double longest = 0;    // from one station to the next along the centre line, file units, > 0
  double turn = 0.35;    // of the lines between them, radians
  double deviation = 0;  // of the surface from these lines, file units, > 0
  int least = 1;         // parts
};

// Parameters v, increasing, the ends of the domain included (of a ring, too, where they are one place).
// Looked at are the lines of constant u at `us` (at least one): they bend with the yarn, with its twist and
// where its section changes.
std::vector<double> stations(const yarn::Body& body, std::span<const double> us, const StationRules& rules);

}  // namespace selvage::fem
