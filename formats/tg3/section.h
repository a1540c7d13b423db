// Sections of TexGen's yarns: closed curves in the plane across the yarn, x to its side and y up, each over
// its own parameter t from 0 to 1 (counter-clockwise from the +x side), by which TexGen blends one section
// into another.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"

namespace selvage::formats::tg3 {

struct Section {
  std::function<Vec2(double t)> point;
  std::vector<double> corners;  // every t in [0, 1) at which the curve may have a corner, increasing
  bool is_straight = false;     // between its corners
  // Of a polygon that keeps its points: they are blended one for one, t counts them.
  std::vector<Vec2> kept{};
};

Section ellipse(double width, double height);
// x = width/2 cos a (about x = offset on both sides of it), y = +-height/2 |sin a|^power, a = 2 pi t.
Section power_ellipse(double width, double height, double power, double offset);
// Two arcs of circles that meet in tips at x = +-width/2, y = distortion; each is passed evenly. height <=
// width, |distortion| < height / 2.
Section lenticular(double width, double height, double distortion);
// t by the length of the outline from the middle of its right side.
Section rectangle(double width, double height);
// Cubic Beziers end to end, three points each; at least 6 points.
Section bezier(std::vector<Vec2> points);
// t by the length of the outline, or of a polygon that keeps its points by their number; at least 3 points.
Section polygon(std::vector<Vec2> points, bool keeps_points);
Section rotated(Section section, double angle);
Section scaled(Section section, const Vec2& factors);
// From each division on the section of the same number; before the first the last one. Error (geometry): two
// of them do not meet at a division.
Result<Section> hybrid(std::vector<double> divisions, std::vector<Section> sections);

// The corners of all of them, each once.
std::vector<double> corners_of(std::span<const Section* const> sections);

// Of its box.
Vec2 sizes_of(const Section& section);

// Counter-clockwise positive, of `samples` chords between two corners each.
double area_of(const Section& section, int samples = 64);

}  // namespace selvage::formats::tg3
