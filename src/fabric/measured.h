// Yarns as points, measured (micro-CT) or written by `--lines`: what a file of points says, and the yarns
// that it means.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "core/source.h"
#include "core/text_report.h"
#include "core/units.h"
#include "fabric/model.h"

namespace selvage::fabric {

// The points of one yarn in their order: of its centre line, or of the outlines of its sections one after the
// other. Every list but `points` and `places` is empty, or has an entry a point.
struct MeasuredYarn {
  std::string name;
  std::optional<Role> role;
  std::vector<Vec3> points;
  std::vector<TextPlace> places;
  std::vector<double> parameters;  // of a centre line as a cubic B-spline, increasing,
  std::vector<Vec3> derivatives;   // and its derivatives there by the parameter: both or none
  std::vector<std::optional<SizeAt>> sizes;
  std::vector<Vec3> ups;  // directions of the thickness
  std::vector<std::size_t>
      sections;  // of outlines: the index of each one's first point; empty: a centre line
};

// Lengths in the unit that the file names, or without one in that of who reads it.
struct Measured {
  std::optional<Unit> units;
  std::vector<MeasuredYarn> yarns;
};

// The yarn of these points, its name, role, `up` and shape (and, where its points say a size and
// `takes_size`, its section):
// - outlines: a grid through the sections, which all get as many points, evenly along their outlines, and
// begin where
//   the surface is twisted least;
// - a centre line with derivatives and no error: the cubic B-spline that has them, its control points and
// knots (no
//   more than it needs);
// - any other centre line: a path through the points (chord), or near them (smooth).
// A line whose last point is its first is a ring. Errors (malformed, geometry) at the place of a point: fewer
// than two points (rings: four; outlines: two of three points), two equal points in a row, a line that
// doubles back on itself: that turns by more than 120 degrees where both its steps are longer than twice the
// error, or 150 degrees without one.
Result<Yarn> yarn_of(const MeasuredYarn& measured, const std::optional<double>& error, bool takes_size);

// The whole file as a fabric, in its unit (else mm). What is wrong goes to `diagnostics`: errors of yarn_of,
// and centre lines of which nothing says how thick they are.
Fabric fabric_of(const Measured& measured, const Source& source, Diagnostics& diagnostics);

// The same points in another unit.
void scale(MeasuredYarn& measured, double factor);

}  // namespace selvage::fabric
