// Two yarns' B-spline surfaces where they are nearest or deepest in each other.
#pragma once

#include <optional>

#include "solid/tessellation.h"
#include "yarn/body.h"

namespace selvage::solid {

// p on the first surface, q on the second, the outward normal at p opposite to that at q and both along p -
// q: a critical point of the distance. depth = (p - q) . normal: above 0 the yarns share space there, below 0
// it is minus their gap.
struct Critical {
  Vec3 p = Vec3::Zero(), q = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  // the first's, unit, outward
  double depth = 0;
};

// By damped Newton steps from the sites (u, v); where solutions form a line (parallel yarns), some point of
// it. Nothing: it does not converge, as at sharp edges or past a yarn's end.
std::optional<Critical> find_critical(const yarn::Body& a, const Vec2& site_a, const yarn::Body& b,
                                      const Vec2& site_b);

// A rectangle of a body's parameters. It may pass the seam (and, on a ring, the first section).
struct Window {
  Vec2 low = Vec2::Zero(), high = Vec2::Zero();
};

// That part of the body's surface as triangles, outward, with their sites: cells x cells, cut at the knots
// too.
Tessellation sample(const yarn::Body& body, const Window& window, int cells);

}  // namespace selvage::solid
