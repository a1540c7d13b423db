// Yarns for the tests of the IGES writer: made from control grids, sealed by the library's own end faces.
#pragma once

#include <string>
#include <vector>

#include "yarn/body.h"

namespace selvage::test {

// A yarn along x over 0..length that waves in z with `amplitude`, elliptic (width across, height), of 16
// control points round and 16 sections: the paper's 18 x 16 body once it is clamped. Shifted to `y`, starting
// at phase `phase`.
struct Wave {
  double length = 4, width = 0.4, height = 0.2, amplitude = 0.15, y = 0, phase = 0;
  int sections = 16, round = 16;
  double weight_step = 0;  // above 0: rational, weights 1, 1 + step, 1, ... round the section
  bool reversed = false;   // the section's points run the other way round: S_u x S_v points inward
};
yarn::Body wave(const std::string& name, const Wave& shape, yarn::EndStyle ends);

// A ring of major radius 5 in the xy-plane, section of diameter 1.
yarn::Body ring(const std::string& name);

// Four yarns: two warps along x, two wefts along y; roles, colours and names as in a fabric.
std::vector<yarn::Body> plain_weave(yarn::EndStyle ends);

}  // namespace selvage::test
