// The cross-section of a yarn: the shape that is swept along its path. Axes: x across, y through the
// thickness; the origin is on the path. Sizes are full widths in file units.
#pragma once

#include <variant>
#include <vector>

#include "core/vec.h"

namespace selvage::yarn {

struct Circle {
  double diameter = 0;  // 0: the thread's diameter
  bool operator==(const Circle&) const = default;
};
struct Ellipse {
  double width = 0, height = 0;
  bool operator==(const Ellipse&) const = default;
};
// Two circular arcs that meet in sharp tips at x = +-width/2.
struct Lenticular {
  double width = 0, height = 0;
  bool operator==(const Lenticular&) const = default;
};
// A rectangle with two half circles at its short sides (upright when height > width).
struct Racetrack {
  double width = 0, height = 0;
  bool operator==(const Racetrack&) const = default;
};
// x = width/2 cos(a), y = height/2 sign(sin a) |sin a|^exponent. 1 is the ellipse, below 1 nears a rectangle,
// above 1 a lens with hollow flanks at the tips.
struct Power {
  double width = 0, height = 0, exponent = 1;
  bool operator==(const Power&) const = default;
};
// Seven-point uniform cubic of the warp-knit loop method (see methods.md, 2).
struct Loop7 {
  double diameter = 0;  // 0: the thread's diameter
  bool operator==(const Loop7&) const = default;
};
// Straight edges between these corners, at least 3, in order; the first is not repeated at the end.
struct Polygon {
  std::vector<Vec2> corners;
  bool operator==(const Polygon&) const = default;
};

using Section = std::variant<Circle, Ellipse, Lenticular, Racetrack, Power, Loop7, Polygon>;

}  // namespace selvage::yarn
