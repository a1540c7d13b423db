// Leno: pairs of warps, a standing end and a doup end that crosses it between any two picks. The doup end
// passes over every pick and below the standing end between them, which passes under every pick; picks are
// straight.
//
// Half: the doup end goes from one side of the standing end to the other and at the next crossing back
// (gauze). Full: it goes all round the standing end from pick to pick, always the same way. (Watson's
// Advanced Textile Design, chapter on leno or cross weaving.)
#pragma once

#include <vector>

#include "core/vec.h"
#include "fabric/clearance.h"

namespace selvage::fabric {

// Lengths in file units; a pair's own place is y = 0, the picks lie in z = 0.
struct LenoShape {
  bool full = false;
  double pick = 1;      // pitch of the picks
  double over = 0;      // height of the doup end's centre line on a pick
  double under = 0;     // depth of the standing end's below a pick
  double crossing = 0;  // depth of the doup end's half way between picks; the standing end's height there
  double side =
      0;  // of the doup end, at the most: half on each pick, full a quarter of the way to the next one
};

struct LenoPoint {
  Vec3 position, derivative;  // by t
};
// At t picks: pick number k is at x = (k + 1/2) pitch, t = k.
LenoPoint leno_point(const LenoShape& shape, bool is_doup, double t);

// Sections as polygons, and their largest size across and through the cloth.
struct LenoYarn {
  std::vector<Vec2> outline;
  double width = 0, height = 0;
};
// Of the tightest bend of a warp, half its thickness to the radius: 1 and more fold.
double tightest_bend(const LenoShape& shape, bool is_doup, double height);

// The lowest heights and the smallest side at which the ends of a pair and the picks keep `wanted` apart, by
// samples on the exact swept sections. Returns the gap that is left: less than `wanted` where there is no
// room for more.
double fit_leno(LenoShape& shape, double wanted, const LenoYarn& standing, const LenoYarn& doup,
                const LenoYarn& pick);

}  // namespace selvage::fabric
