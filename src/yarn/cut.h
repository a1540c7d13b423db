// A yarn cut across into several: for files that cannot hold it in one.
#pragma once

#include <vector>

#include "core/diagnostics.h"
#include "yarn/body.h"

namespace selvage::yarn {

// The yarn as `count` yarns, one after the other, cut at knots of its path so that they have about the same
// number of sections: NAME.part1, NAME.part2, ... Each piece is the same surface over its own part of v, by
// knot insertion: control points that no cut touches keep their bits, and the last row of a piece is the
// first row of the next, to the bit. The yarn's own end faces stay, every cut end gets one of `ends` (where
// the yarn is open, none), so each piece is closed where the yarn is. A ring becomes pieces with ends. Errors
// (geometry): fewer knots inside than cuts; a cut end that cannot be sealed.
Result<std::vector<Body>> cut(const Body& body, int count, EndStyle ends);

}  // namespace selvage::yarn
