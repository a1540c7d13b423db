// The gap between two yarns whose paths are known as functions, before either is swept: constructions choose
// their amplitudes by it.
#pragma once

#include <functional>
#include <vector>

#include "core/vec.h"
#include "yarn/section.h"

namespace selvage::fabric {

// A place on a path with the section's axes; `derivative` by the path's parameter.
struct SweptStation {
  Vec3 position, derivative;
  Vec3 across, up;  // unit, perpendicular to the derivative and to each other
};

struct SweptYarn {
  std::function<SweptStation(double)> at;
  std::vector<Vec2> outline;  // of the section, a polygon
  std::vector<Vec2> fine{};   // the same with a whole multiple of its points; may be empty
};

// Points on the outline of a section of its own size, closest where it bends most, with its corners: `looks`
// of them in each of its spans, which are 32 but for Loop7 (7) and polygons (two a corner).
std::vector<Vec2> outline_polygon(const yarn::Section& section, int looks = 2);
// The same with at least `count` points where the outline is curved.
std::vector<Vec2> dense_outline_polygon(const yarn::Section& section, int count);

// How far the section of its own size reaches from the centre line.
double outline_reach(const yarn::Section& section);

// Distance of a point from a polygon; negative inside.
double signed_distance(const std::vector<Vec2>& polygon, const Vec2& p);

// The least signed distance (negative: inside) of the surface of `a` between two parameters from the section
// of `b` in whose plane each of its points lies, searched from parameter `near_b`, at most `reach_b` away
// from it. Sampled: `stations` along the path; where both yarns have a fine outline it is looked at there
// where the gap is least.
double least_gap(const SweptYarn& a, double from, double to, int stations, const SweptYarn& b, double near_b,
                 double reach_b);

// The same on the outlines alone, refined along the path between the stations where each point of a's outline
// is nearest: a corner of a polygon runs along the yarn as an edge, and crosses another edge at one place
// only.
double refined_gap(const SweptYarn& a, double from, double to, int stations, const SweptYarn& b,
                   double near_b, double reach_b);

}  // namespace selvage::fabric
