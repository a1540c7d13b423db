// The data points of the loops of a weft knit, in units of the yarn's half thickness r.
//
// The knit loop is that of ../shared/references 001 (methods.md, 1): nine points, wales 8 r and courses 7 r
// apart, legs 1.5 r before the cloth's middle plane, sinker and head 1.5 r behind it. Everything else is
// ours. A purl loop is its mirror image in that plane. The feet and legs of a loop lie on the side of its
// own stitch, its head on the side that the stitch above it asks for: behind a knit loop, before a purl loop,
// because it is what the next loop's legs pass. Where own stitch and stitch above differ the leg has two
// points instead of one and crosses the middle plane between them; where neighbours in a course differ the
// sinker crosses the plane at their common point, and each arm gets a point that keeps it on its side of
// the leg that it passes. A loop that is moved to another needle leans: its points move the farther aside the
// higher they lie, before or behind the loops that it crosses.
#pragma once

#include <vector>

#include "core/vec.h"
#include "knit/chart.h"

namespace selvage::fabric {

inline constexpr double wale_spacing = 8;    // in r
inline constexpr double course_spacing = 7;  // in r

// The family of loops from which densities and lengths of loops are met; as preset, the published one. The
// points are spread to the spacings, and what then is free changes the length.
struct LoopShape {
  double wale = wale_spacing, course = course_spacing;  // in r
  // Of the published one: how far feet and shoulders lie from the middle of the leg, how far heads and
  // sinkers reach beyond the line at which loops hold each other, and how far all lies from the middle plane.
  double bulge = 1, overlap = 1, depth = 1;
  // Of the middle planes of both beds' loops from the cloth's, where needles stand opposite each other; in
  // half thicknesses.
  double bed = 0;
};

// The needles and courses of a chart, counted from 0, that a cloth uses; bounds inclusive. What lies outside
// is seen as if it were not there: under the first course nothing is held, the loops of the last one stand as
// if their like followed, and the sinkers at the sides are those of the outer wales.
struct KnitField {
  StitchChart chart;
  long long first_course = 0, last_course = 0;
  long long first_wale = 0, last_wale = 0;
  LoopShape shape = {};
  // Yarns that are knitted together: 2 is a plated jersey, the second yarn behind the first one.
  int ends = 1;
  // A user's own loops, one for each sign of the chart; null: those of the shape.
  const std::vector<OwnLoop>* own = nullptr;
  // Not 0: how far behind the middle plane the sinkers of the second yarn stand, in half thicknesses.
  double pile = 0;
};

// Heads of opposite beds pass each other.
inline constexpr double least_bed = 2.5;

// The wales of one row's yarn; none where first > last.
struct RowExtent {
  long long first = 0, last = -1;
};
RowExtent extent_of(const KnitField& field, long long course);

// The row whose loop the needle of a bed holds when this row begins; first_course - 1: none.
long long held_course(const KnitField& field, long long course, long long wale, int bed);

// Appends the points that one needle gives to one course, from the sinker on its left to the last point
// before the sinker on its right, which is the next needle's first point; none where its yarn does not come.
// x from the left side of the wale (0 .. shape.wale), y from the course's lower crossings, z from the middle
// plane.
void add_stitch_points(const KnitField& field, long long course, long long wale, std::vector<Vec3>& points,
                       int end = 0);

// The last point of a course: x from the right side of the last wale that it has.
Vec3 last_sinker_point(const KnitField& field, long long course, int end = 0);

// Loops of two yarns are so much deeper than those of one.
inline constexpr double plated_depth = 2;
// The least that a pile's sinkers can stand behind the middle plane, and where the cloth's back is; half
// thicknesses.
double least_pile(const LoopShape& shape);
double plated_back(const LoopShape& shape);

}  // namespace selvage::fabric
