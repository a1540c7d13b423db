// The path of one braider: a helix about the z axis, or a zigzag across a strip along x, with an offset
// through the thickness that follows the pattern.
//
// Crossings of braiders stand at equal steps along the axis. A tube of N carriers has N columns of crossings
// round it, a strip N - 1 of them across it, and who is on top at a crossing depends on its column alone: the
// carriers' track fixes it, which is why the ribs of a 2/2 braid run along the axis (Brunnschweiler, Braids
// and Braiding, J. Textile Institute 44, 1953; Potluri et al., Composite Structures 62, 2003).
#pragma once

#include <cstdint>

#include "core/vec.h"

namespace selvage::fabric {

struct BraidShape {
  bool flat = false;        // a strip
  bool planar = false;      // a tube's cloth laid flat about z = 0, columns across it along y
  int carriers = 2;         // N
  int over = 1, under = 1;  // columns in which the braider that runs to +angle (+y) is on top, then below
  double radius = 0;        // tube: of the middle surface, file units
  double step = 1;          // between crossings of one braider, along the axis, file units
  double column = 0;        // not of a tube, which has 2 pi / N of angle: between columns, file units
  double amplitude = 0;     // of the centre line at a crossing, from the middle surface, file units
  double plateau = 0;       // steps before and after a crossing with that full offset, below 1/2

  // Columns count from 0 (tube, any integer) or are 1 .. N - 1 (strip).
  [[nodiscard]] bool is_over(std::int64_t column_number) const;
  // A planar braid's columns, from 0 to N - 1, lie evenly about y = 0: the y of one, or of a place between.
  [[nodiscard]] double level_place(double column_number) const {
    return column * (column_number - 0.5 * (carriers - 1));
  }
};

// One braider. Tube, planar: `start` is its column at t = 0, from where it runs with `direction` (+1, -1).
// Strip: its place on the way there and back at t = 0, of 2 N steps, columns 1 .. N - 1 there and back;
// direction 1.
struct Braider {
  std::int64_t start = 0;
  int direction = 1;
};

struct BraidPoint {
  Vec3 position, derivative;  // by t
};

// The point at t steps: crossing number k is at t = k, and at (k + 1/2) step along the axis.
BraidPoint braid_point(const BraidShape& shape, const Braider& braider, double t);

// +1 on top (outside) at crossing k, -1 below, 0 where a strip's braider turns at an edge.
int braid_state(const BraidShape& shape, const Braider& braider, std::int64_t k);

// Cosine and sine of k / n of a full turn: quarter turns are exact, and places that mirror each other have
// the same bits.
Vec2 unit_at(std::int64_t k, std::int64_t n);

// Strip: columns across it from edge to edge of the centre lines, which turn before the corner of the last
// ones; angle in degrees, between 0 and 90.
double strip_columns(const BraidShape& shape, double angle);

// Strip: radius of the turns at the edges, in the plane of the strip, file units.
double turn_radius(const BraidShape& shape);

}  // namespace selvage::fabric
