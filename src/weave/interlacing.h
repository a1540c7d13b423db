// How a yarn passes from one side of its neighbours to the other, in a plane across the cloth: two arcs round
// what it crosses, and a straight between them, touching both.
//
// F. T. Peirce, The geometry of cloth structure, Journal of the Textile Institute 28 (1937), T45-T96: with
// yarn axes bent on radius D/2, D the sum of both systems' diameters, a yarn of length l between two
// crossings rises by h over the pitch p, weaving at the angle t:
//     p = (l - D t) cos t + D sin t,   h = (l - D t) sin t + D (1 - cos t).
// The same holds for any pair of arcs with D the sum of their radii: flat tows bend on the larger radius of a
// lens, racetracks have a flat between the arcs.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"
#include "yarn/outline.h"
#include "yarn/path.h"
#include "yarn/section.h"

namespace selvage::fabric {

struct Bridge {
  double angle = 0;     // by which each arc turns, radians
  double straight = 0;  // length of the straight between the arcs
};

// The bridge that rises by `height` >= 0 over `pitch` between arcs whose radii sum up to `spread` > 0; none
// where there is no such line, or only one that leans back over its own start (the yarn would have to turn by
// more than 90 degrees).
std::optional<Bridge> find_bridge(double pitch, double height, double spread);

// The smallest pitch that has a bridge of this height.
double smallest_pitch(double height, double spread);
// The largest height that has a bridge over this pitch; infinity where there is no largest.
double largest_height(double pitch, double spread);

// What a yarn bends round: its axis runs flat above the middle of the other section, and then on an arc.
struct Obstacle {
  double flat = 0;    // half the length of the flat
  double radius = 0;  // of the axis's arc: the other's, plus half the own thickness
};

// What a yarn of this thickness bends round when it crosses a section at this clearance: a circle of its
// thickness (round), the arc of a lens, or a racetrack.
enum class Bend { round, lens, racetrack };
Obstacle obstacle_of(Bend bend, const yarn::SectionSize& other, double own_thickness, double clearance);

// A yarn above or below one other: where it is level.
struct Pass {
  double s = 0, z = 0;  // along the yarn, and through the cloth
  Obstacle below, above;
};

// The centre line through these passes (increasing s), level at each of them and from the first and last to
// s_from and s_to, as segments and arcs. `place` takes (s, z) into space. Error (geometry): two passes
// without a bridge; the message names the smallest distance.
Result<yarn::CentreLine> bridge_passes(const std::vector<Pass>& passes, double s_from, double s_to,
                                       Vec3 (*place)(double s, double z, double across), double across);

}  // namespace selvage::fabric
