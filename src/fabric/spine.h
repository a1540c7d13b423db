// Lines that run beside a centre line and turn about it: the geometry of plies and filaments.
#pragma once

#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"
#include "fabric/disc_packing.h"
#include "yarn/frame.h"
#include "yarn/path.h"

namespace selvage::fabric {

// A centre line with its frames, at as many stations as lines at a distance `reach` need that turn about it.
struct Spine {
  bool closed = false;
  double turning = 0;               // radians per file unit about the tangent, right-handed
  std::vector<yarn::Frame> frames;  // a closed one's last frame is its first again
  std::vector<double> parameters, lengths;
  // The steepest inclination of a line at `reach` against the centre line is atan(inclination): by turning
  // and by the frame's own turn, on the inside of bends.
  double inclination = 0;
};

// On a closed line the turning is brought to the nearest one that closes. Errors: geometry (a bend tighter
// than `reach`, what FrameField says), limit.
Result<Spine> make_spine(const yarn::CentreLine& line, const yarn::FrameGuide& guide, double turning,
                         double reach);

// The line through `place` of the section (x across, y up) at the start. Cubic, through the stations.
yarn::CentreLine strand_of(const Spine& spine, const Vec2& place);

// The direction away from the spine at its start: up where `place` is the middle.
Vec3 outward(const Spine& spine, const Vec2& place);

// The largest diameter of lines through these places that turn about the origin, with the given inclination
// at distance `reach`, at which none overlap. As packed: places are scaled so that the lines fill the circle
// of radius `reach`; else they stand as they are.
double largest_diameter(const DiscPacking& packing, double reach, double inclination, bool scaled);

// The places of a packing in the circle of radius `reach`, the outermost discs of this diameter touching it.
Vec2 place_of(const DiscPacking& packing, std::size_t disc, double reach, double diameter);

}  // namespace selvage::fabric
