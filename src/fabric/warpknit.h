// The construction `warpknit` (formats/txt/README.md): one yarn a guide of every bar, over all courses.
//
// Wales run along +y, side by side in x: space s between needles (lapping.h) lies at x = s * wale pitch for
// the first guide of a bar, guide g is g - 1 pitches further, and the loops of course j stand on
// y = (j - 1) * course pitch. +z is the technical face, where the legs of the loops lie, -z the technical
// back with the underlaps. A loop rises from its foot, at the back, through the loop below (the one of the
// last course in which a bar knitted) to the face, and its head goes behind the legs of the next loop.
//
// What lies over what: from the back the underlaps of the first bar (the front bar), then those of the
// second, ..., then the heads and, on the face, the legs, those of the front bar foremost; so its feet stand
// outside of those of the other bars. A laid-in course has no loop: the yarn stays in the layer of its bar's
// underlaps, where those of the bars before it hold it against the loops of the needles that it crosses.
// The overlap of a fall-plate bar is a low arch over the feet of that course's loops, behind their legs,
// which does not pass through the loop below. At the edges of the needle bed loops of the course below may be
// missing, as in a strip cut from a wider fabric.
//
// Centre lines are by the loop path method of ../shared/references 000 (inserted control points), which
// nearly meets its data points; by how much it misses is in CentreLine::largest_miss.
#pragma once

#include <memory>

#include "fabric/plan.h"

namespace selvage::fabric {

struct BuildOptions;

// Errors: at their lines, a lapping's in its text: malformed, an overlap across more than one needle, a bar
// that knits nowhere, pitches too small for the yarns (the smallest one is named). `fabric` and `warpknit`
// outlive the construction; warnings go to `diagnostics`.
Result<std::unique_ptr<Construction>> make_warpknit(const Fabric& fabric, const Warpknit& warpknit,
                                                    const BuildOptions& options, Diagnostics& diagnostics);

}  // namespace selvage::fabric
