// Whether yarns that were moved are still interlaced as before.
//
// Every point of the centre lines is taken in a straight line from its place before to its place after
// (points of equal parameter belong together). Where on that way no line meets another one or itself, the
// movement is an isotopy: over stays over, loops hang in the same loops. Where lines do meet, one was taken
// through the other. This needs no direction to look along, so it holds for tubes as for flat cloth.
//
// Between samples a line is off its chord by h^2 / 8 of its second derivative at most, and the least distance
// of two moving chords is bounded from below by conservative advancement (their distance now, less what they
// can move): what is not listed did not happen.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/diagnostics.h"
#include "yarn/body.h"

namespace selvage::contact {

// One line was taken through another one, or through another part of itself.
struct Passage {
  std::size_t a = 0, b = 0;   // indices of the yarns, a <= b
  double at_a = 0, at_b = 0;  // parameters of their axes
  double time = 0;            // 0: before, 1: after
  Vec3 at = Vec3::Zero();     // where they met, file units
};

// The passages between two states of the same yarns, one for each place (a pair of yarns has several where
// they lie apart), in the order of the yarns and parameters. Two places of one yarn nearer to each other
// along it than one and a half times its section's width are no pair. Errors (geometry): yarns that do not
// correspond (their number, or the parameters of an axis), numbers that are not finite.
Result<std::vector<Passage>> find_passages(std::span<const yarn::Body> before,
                                           std::span<const yarn::Body> after);

}  // namespace selvage::contact
